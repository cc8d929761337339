"""The command `graphdyn study`."""
