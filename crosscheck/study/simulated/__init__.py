"""What a study simulates: robots, controllers, reference motions and noisy recordings."""
