"""Delays of the torques behind the motion."""
