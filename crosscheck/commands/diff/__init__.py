"""The command `graphdyn diff`."""
