"""The command `graphdyn robots`."""
