"""The command `graphdyn bench`."""
