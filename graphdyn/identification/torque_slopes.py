"""How the torque of a model changes with the motion: G = ∂τ/∂(q, v, a).

Central differences of W x, so that every term of a torque model counts: friction and columns of users as well as bodies
with parameters that no real body has. With the standard deviations of the errors of q, v and a as steps, sign(v) has a
slope where the error may turn it, and none elsewhere.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.identification.samples import Samples
from graphdyn.identification.torque_model import TorqueModel
from graphdyn.layout import Array

MOTION = ("q", "v", "a")


def torque_slopes(torque_model: TorqueModel, x: Array, motion: Samples, steps: Array) -> Array:
    """G (N, n, 3 n): columns of all q, then v, then a.

    x: parameters (p,); steps: of q, v and a (3, n); zero where the slope is not wanted, which is zero then
    """
    n = motion.q.shape[1]
    slopes = np.zeros((len(motion), n, 3 * n))
    for d, name in enumerate(MOTION):
        for j in np.flatnonzero(steps[d]):
            aside = steps[d, j] * np.eye(n)[j]
            up, down = (
                torque_model.torque(replace(motion, **{name: getattr(motion, name) + sign * aside}), x)
                for sign in (1, -1)
            )
            slopes[..., d * n + j] = (up - down) / (2 * steps[d, j])
    return slopes
