"""What a result is, and its three renderings: text, page, JSON. Not public."""
