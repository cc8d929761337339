"""The paper and its errata, the benchmark, the description of a robot. Not public."""
