"""Inertials that cannot be right, and the changes of their numbers that make them right."""

from urdf.reading.corrections.choosing import SuspectInertial, only_change, suspect_inertials
from urdf.reading.corrections.correcting import candidates, correct_inertials

__all__ = ["SuspectInertial", "candidates", "correct_inertials", "only_change", "suspect_inertials"]
