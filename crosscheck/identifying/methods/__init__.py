"""Identification methods and torque terms by name, and methods in addition to graphdyn's own."""
