"""The command `graphdyn view`."""
