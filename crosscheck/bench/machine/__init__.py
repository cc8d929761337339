"""The machine under the benchmark: its load, its limits, and times taken on it."""
