"""The command `graphdyn excite`."""
