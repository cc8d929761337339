"""The command `graphdyn vectors`."""
