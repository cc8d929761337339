"""Recorded programs as code for others to take along, which computes without graphdyn."""
