"""Rigidly connected links become one body: masses, first moments and tensors add."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn import Placement
from graphdyn._inertia import parallel_axis
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Inertial:
    """mass [kg]; center of mass (3,) [m]; tensor (3, 3) about it [kg m²], both in the axes of one link frame."""

    mass: float
    center: Array
    tensor: Array

    def seen_from(self, placement: Placement) -> Inertial:
        """The same inertial in another frame; placement: of its own frame in that one."""
        rotation = placement.rotation
        rotated = not np.array_equal(rotation, np.eye(3))  # an unrotated tensor keeps every bit
        return Inertial(
            self.mass,
            rotation @ self.center + placement.translation,
            rotation @ self.tensor @ rotation.T if rotated else self.tensor,
        )


NOTHING = Inertial(0.0, np.zeros(3), np.zeros((3, 3)))


def fuse(parts: Sequence[Inertial]) -> Inertial:
    """One inertial for all parts, given in the same frame.

    The tensor is summed about the common center of mass, from parallel-axis terms that are all ≥ 0: no cancellation.
    """
    if not parts:
        return NOTHING
    if len(parts) == 1:
        return parts[0]
    mass = sum(part.mass for part in parts)
    moment = np.sum([part.mass * part.center for part in parts], axis=0)
    center = moment / mass if mass > 0 else np.zeros(3)
    tensors = [part.tensor + parallel_axis(part.mass, part.center - center) for part in parts]
    return Inertial(mass, center, np.sum(tensors, axis=0))
