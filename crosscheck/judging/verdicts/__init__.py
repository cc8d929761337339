"""The verdict on a function and its diagnosis."""
