"""Estimators for data that arrive sample by sample."""
