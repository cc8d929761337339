"""The command `graphdyn recording`."""
