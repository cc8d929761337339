"""The format `graphdyn identify 2`."""
