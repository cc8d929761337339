"""Filters, derivatives, resampling, decimation, and the division of recordings."""
