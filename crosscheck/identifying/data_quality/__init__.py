"""Data quality as text: the faults of a recording, and the mapping lines that correct them."""
