"""Linear algebra of the identification: base parameters, rank, triangular factors, least squares with covariance."""
