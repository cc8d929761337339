"""Records of results: what JSON files hold, their schemas, and the docstrings that describe them."""
