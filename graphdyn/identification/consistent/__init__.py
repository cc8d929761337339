"""Least squares over physically consistent inertias: the common parts of the physically consistent estimators."""
