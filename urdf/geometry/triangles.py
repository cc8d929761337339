"""Triangles without a place: what a box, a cylinder or a part of a mesh file consists of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.layout import Array
from urdf.geometry.shape import Color, Faces


@dataclass(frozen=True, eq=False)
class Triangles:
    """vertices (k, 3) [m]; faces (m, 3), anticlockwise from outside; color: None where none is given."""

    vertices: Array
    faces: Faces
    color: Color | None = None

    def __post_init__(self) -> None:
        self.vertices.setflags(write=False)
        self.faces.setflags(write=False)

    def scaled(self, scale: Array) -> Triangles:
        """Scaled along the three axes (3,). A mirrored mesh has its faces reversed: they stay anticlockwise."""
        if np.array_equal(scale, np.ones(3)):
            return self
        faces = self.faces[:, ::-1].copy() if np.prod(np.sign(scale)) < 0 else self.faces
        return Triangles(self.vertices * scale, faces, self.color)


def joined(parts: Sequence[Triangles]) -> Triangles:
    """All as one, with the color of the first."""
    if len(parts) == 1:
        return parts[0]
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + start for part, start in zip(parts, starts, strict=False)]
    return Triangles(np.concatenate([part.vertices for part in parts]), np.concatenate(faces), parts[0].color)
