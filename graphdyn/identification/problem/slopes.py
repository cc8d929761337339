"""Slopes of the torque by the motion: ∂τ/∂(q, v, a).

They are central differences of W x, and hold for every term of a torque model: friction, columns of users, and bodies
whose parameters are physically inconsistent.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

MOTION_NAMES = ("q", "v", "a")


def torque_slopes(torque_model: TorqueModel, x: Array, motion: Samples, steps: Array) -> Array:
    """G (N, n, 3 n): columns of all q, then v, then a.

    x: parameters (p,); steps: of q, v and a (3, n); a zero step gives a slope of zero
    """
    n = motion.q.shape[1]
    slopes = np.zeros((len(motion), n, 3 * n))
    for d, name in enumerate(MOTION_NAMES):
        for j in np.flatnonzero(steps[d]):
            aside = steps[d, j] * np.eye(n)[j]
            up, down = (
                torque_model.torque(replace(motion, **{name: getattr(motion, name) + sign * aside}), x)
                for sign in (1, -1)
            )
            slopes[..., d * n + j] = (up - down) / (2 * steps[d, j])
    return slopes
