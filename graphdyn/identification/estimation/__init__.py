"""Common parts of all estimators: the estimate, cross-validation, plausibility, and the comparison of methods."""
