"""The implementations that the benchmark compares, one file for each library."""
