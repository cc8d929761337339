"""Checks of recorded values and time stamps."""
