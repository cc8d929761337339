"""Trials of possible causes: what each of them gains."""
