"""Inertials that cannot be right, and the changes of their numbers that make them right."""

from urdf.reading.corrections.changes import DENSITIES, Correction, changes, shifted
from urdf.reading.corrections.choosing import SuspectInertial, only_change, suspect_inertials
from urdf.reading.corrections.correcting import candidates, correct_inertials
from urdf.reading.corrections.twins import mirrored_names

__all__ = [
    "DENSITIES",
    "Correction",
    "SuspectInertial",
    "candidates",
    "changes",
    "correct_inertials",
    "mirrored_names",
    "only_change",
    "shifted",
    "suspect_inertials",
]
