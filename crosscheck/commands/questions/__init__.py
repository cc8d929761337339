"""The command `graphdyn questions`."""
