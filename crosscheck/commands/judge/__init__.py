"""The command `graphdyn judge`."""
