"""Slips in one place of a recursion: every operation of the formulations that people write, done wrong in turn."""
