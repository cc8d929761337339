"""What several parts of the record of `graphdyn show` are made of."""

from __future__ import annotations

from typing import Any

import numpy as np

from graphdyn import Placement, RobotModel
from urdf._rpy import rpy_from_rotation


def placed(placement: Placement) -> dict[str, Any]:
    """The fields xyz [m] and rpy [degree] of a placement."""
    rpy = np.rad2deg(rpy_from_rotation(placement.rotation))
    return {"xyz": placement.translation.tolist(), "rpy": rpy.tolist()}


def vertex(model: RobotModel, number: int) -> str:
    """Name of a body, or of the ground."""
    return (model.base_name, *model.body_names)[number]
