"""The search for faults that explain the observed answers."""
