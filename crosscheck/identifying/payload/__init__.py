"""Loads and gains from recordings of motor currents."""
