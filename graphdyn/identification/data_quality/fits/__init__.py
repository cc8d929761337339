"""Fits that decide on the data quality of a recording."""
