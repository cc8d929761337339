"""Faults of recordings, by what they change: columns, torques, rows, or the whole arm."""
