"""The result of an identification: models, baselines, errors, recommendation."""
