"""Recursions of robots whose joints depend on each other: couplings, chords, independent joints."""
