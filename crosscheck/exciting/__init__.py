"""Exciting motions for robots from files: comparisons, recorded motions, files that robots take."""
