"""Faults of dynamics codes: one file for each place where they are made."""
