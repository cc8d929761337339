"""The command `graphdyn crosscheck`."""
