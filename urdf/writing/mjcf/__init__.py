"""MJCF files: new ones from a model, and new numbers in existing ones."""
