"""Identification methods and torque terms by name; methods beside graphdyn's own."""
