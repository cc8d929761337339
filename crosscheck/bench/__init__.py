"""The benchmark: graphdyn and other libraries, measured in turns in one run."""
