"""Search for the faults of a recording among what was tried."""
