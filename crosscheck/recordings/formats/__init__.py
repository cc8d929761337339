"""File formats of recordings: one file for each."""
