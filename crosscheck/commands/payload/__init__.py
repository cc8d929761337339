"""The command `graphdyn payload`."""
