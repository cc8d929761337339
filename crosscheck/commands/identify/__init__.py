"""The command `graphdyn identify`."""
