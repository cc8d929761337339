"""Which frames are compared, and in which axes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, get_args

import numpy as np

from graphdyn import RobotModel
from graphdyn.arguments import Reference
from graphdyn.layout import Array

FRAME_REFERENCES: tuple[Reference, ...] = get_args(Reference)
"""Points and axes in which a frame is described, in the words of graphdyn.frame_velocity."""


def compared_frames(model: RobotModel) -> tuple[str, ...]:
    """Frames that are compared: of every leaf of the tree the last frame fixed in it, or the body itself; and the last
    one fixed in any body."""
    fixed = {frame.body: frame.name for frame in model.frames if frame.body > 0}
    leaves = [i for i in range(1, model.n_bodies + 1) if not model.graph.outside(i)]
    names = [fixed.get(i, model.bodies[i - 1].name) for i in leaves]
    return tuple(dict.fromkeys([*names, *list(fixed.values())[-1:]]))


def of_frames(model: RobotModel, verb: Callable[..., Array], *arrays: Array, **keywords: Any) -> Array:
    """The answers of a verb that speaks of a frame, for every reference and every compared frame (…, 3, m, …)."""
    axis = arrays[0].ndim - 1
    per_reference = [
        [verb(model, *arrays, name, reference=reference, **keywords) for name in compared_frames(model)]
        for reference in FRAME_REFERENCES
    ]
    return np.stack([np.stack(answers, axis) for answers in per_reference], axis)
