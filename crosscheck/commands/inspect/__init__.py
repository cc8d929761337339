"""The command `graphdyn inspect`."""
