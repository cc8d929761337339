"""Another gravity vector."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.judging.faults.fault import Family, Said
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array

ROUND = 1e-6
"""Accuracy of fitted components [m/s²], well below what makes a difference."""


def gravity(model: RobotModel) -> Iterator[Family]:
    """Components in axes of the ground, to which torques at rest are linear."""
    ours = model.base.rotation.T @ model.gravity
    yield Family(ours, lambda code, g: code.but(gravity=g), lambda g: [_said(ours, g)])


def _said(ours: Array, found: Array) -> Said:
    shown, here = (", ".join(f"{x:.6g}" for x in np.where(np.abs(g) < ROUND, 0.0, g)) for g in (found, ours))
    factor = float(found @ ours / (ours @ ours)) if ours.any() else np.nan
    size = 1
    if not np.abs(found).max() > ROUND:
        message = "gravity is left out"
    elif np.abs(found + ours).max() < ROUND:
        message = "gravity has the opposite sign"
    elif np.abs(found - factor * ours).max() < ROUND:
        message = f"gravity is {np.linalg.norm(found):.6g} m/s², not {np.linalg.norm(ours):.6g} m/s²"
    else:
        size = 2
        message = f"gravity acts along ({shown}), not ({here}) m/s², or the base is turned"
    numbers = tuple(
        FittedNumber(f"g_{axis}", float(x), float(y), "m/s²") for axis, x, y in zip("xyz", found, ours, strict=True)
    )
    remedy = f"use the gravity vector ({here}) m/s² in the axes of the base"
    return Said("gravity", message, remedy, size, numbers)
