"""The command `graphdyn cache`."""
