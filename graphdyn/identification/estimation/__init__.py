"""What all estimators share: the estimate, cross-validation, plausibility, and the comparison of methods."""
