"""Measured samples, and the equations of consecutive samples, in runs and in parts, with or without a filter."""
