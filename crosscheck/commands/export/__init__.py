"""The command `graphdyn export`."""
