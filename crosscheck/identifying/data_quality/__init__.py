"""Data quality in words: what is wrong with a recording, and the mapping lines that correct it."""
