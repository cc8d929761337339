"""The command `graphdyn show`."""
