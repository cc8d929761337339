"""Mesh files as triangles, read within limits, and fewer of them."""
