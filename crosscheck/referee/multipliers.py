"""The five multipliers of every joint, from the wrenches of a reference implementation."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from graphdyn import RobotModel
from graphdyn.layout import ANGULAR, LINEAR


def multipliers_of(model: RobotModel, rotation: NDArray[Any], wrenches: NDArray[Any]) -> NDArray[Any]:
    """The multipliers (N, n, 5) of a reference implementation's joint wrenches, as docs/notation.md defines them.

    rotation: R_0j of all bodies (N, n, 3, 3); wrenches: at O_j in link axes (N, n, 6); complex for complex steps
    """
    force, moment = (np.einsum("...jab,...jb->...ja", rotation, wrenches[..., part]) for part in (LINEAR, ANGULAR))
    result = np.empty((*wrenches.shape[:-1], 5), dtype=np.result_type(rotation, wrenches))
    for k, joint in enumerate(model.joints):
        inside = rotation[..., joint.inside - 1, :, :] if joint.inside else model.base.rotation
        t_1, t_2, p = ((inside @ joint.placement.rotation) @ x for x in (*joint.axis_normals, joint.axis))
        f, m = force[..., k, :], moment[..., k, :]
        if joint.is_prismatic:
            rows = [(f * t_1).sum(-1), (f * t_2).sum(-1), (m * t_1).sum(-1), (m * t_2).sum(-1), (m * p).sum(-1)]
        else:
            rows = [f[..., 0], f[..., 1], f[..., 2], (m * t_1).sum(-1), (m * t_2).sum(-1)]
        result[..., k, :] = np.stack(rows, axis=-1)
    return result
