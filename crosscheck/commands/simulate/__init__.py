"""The command `graphdyn simulate`."""
