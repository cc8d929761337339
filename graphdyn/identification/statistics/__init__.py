"""Statistics of residuals: their size, whiteness, correlation in time, and standard deviations that allow for it."""
