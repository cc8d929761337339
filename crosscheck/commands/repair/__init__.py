"""The command `graphdyn repair`."""
