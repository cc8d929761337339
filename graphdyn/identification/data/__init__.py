"""Measured samples and the equations of consecutive samples, in runs and in parts, filtered or not."""
