"""Placement of one frame in another: an element of SE(3)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from graphdyn._errors import InvalidModel
from graphdyn.layout import Array

ORTHONORMALITY = 1e-9
"""Largest entry of RᵀR - E that still counts as a rotation. A product of some hundred rotations stays below 1e-13."""


@dataclass(frozen=True, eq=False)
class Placement:
    """Frame b in frame a: a point with coordinates x in b has R x + t in a.

    rotation: R, columns are the axes of b in a             (3, 3)
    translation: t, the origin of b in a                    (3,)  [m]

    Raises InvalidModel for wrong shapes, NaN or infinity, or a matrix that is not a proper rotation.
    """

    rotation: Array = field(default_factory=lambda: np.eye(3))
    translation: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        for name, shape in (("rotation", (3, 3)), ("translation", (3,))):
            try:
                value = np.array(getattr(self, name), dtype=float)
            except (TypeError, ValueError) as error:
                raise InvalidModel(f"{name} is not numeric: {getattr(self, name)!r}") from error
            if value.shape != shape:
                raise InvalidModel(f"{name} has shape {value.shape}, expected {shape}")
            if not np.all(np.isfinite(value)):
                raise InvalidModel(f"{name} contains NaN or infinity: {value.tolist()}")
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        defect = np.abs(self.rotation.T @ self.rotation - np.eye(3)).max()
        if defect > ORTHONORMALITY or np.linalg.det(self.rotation) < 0:
            raise InvalidModel(f"rotation is not a proper rotation matrix (|RᵀR - E| = {defect:.1e})")

    def __matmul__(self, other: Placement) -> Placement:
        """Frame c in a, from b in a (self) and c in b (other)."""
        return Placement(self.rotation @ other.rotation, self.rotation @ other.translation + self.translation)

    def inverse(self) -> Placement:
        """Frame a in b."""
        return Placement(self.rotation.T, -self.rotation.T @ self.translation)
