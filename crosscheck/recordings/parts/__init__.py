"""Recordings larger than memory, read in windows and in parts."""
