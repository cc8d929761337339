"""The shapes of a robot, as urdf.shapes gives them, and why one cannot be read."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn import Placement
from graphdyn.display import short_repr
from graphdyn.layout import Array
from urdf.errors import one_line


class UnreadableMesh(Exception):
    """The reason, on one line; caught where the drawings of a robot are read, and listed."""

    def __init__(self, reason: str):
        super().__init__(one_line(reason))


Faces = NDArray[np.int64]
"""Per triangle the numbers of its vertices                (m, 3)."""

Color = tuple[float, float, float, float]
"""Red, green, blue and opacity, 0 to 1."""

DEFAULT_COLOR: Color = (0.72, 0.74, 0.78, 1.0)
"""Color of a shape for which neither the URDF file nor the mesh file has one."""


@dataclass(frozen=True, eq=False)
@short_repr
class Shape:
    """A triangle mesh that a body of the model carries.

    body: the body by name; the model's base_name for what never moves
    link: the link of the file to which the shape belongs: the body's own, or one that is fused into it
    placement: of the shape's axes in the link frame of the body
    vertices: in the shape's axes                           (k, 3)  [m]
    faces: three vertices each, counterclockwise from outside  (m, 3)
    color: red, green, blue and opacity, 0 to 1
    file: the mesh file; None for a box, cylinder, sphere or capsule

    The arrays cannot be written: several shapes may share them.
    """

    body: str
    link: str
    placement: Placement
    vertices: Array
    faces: Faces
    color: Color = DEFAULT_COLOR
    file: str | None = None


@dataclass(frozen=True)
class MissingShape:
    """A <visual> or <collision> that cannot be shown.

    file: the mesh file as the URDF names it; None where there is none; reason: why, and what to do
    """

    link: str
    file: str | None
    reason: str


@dataclass(frozen=True, eq=False)
@short_repr
class Shapes:
    """All shapes of a robot, in the order of the file, and those that cannot be shown."""

    meshes: tuple[Shape, ...]
    missing: tuple[MissingShape, ...]
