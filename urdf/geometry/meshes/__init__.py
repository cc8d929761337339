"""Mesh files as triangles, read within limits; primitives; fewer triangles."""
