"""Triangles without a place: what a box, a cylinder or a part of a mesh file consists of, and fewer of them.

M. Garland, P. Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH 1997 (fast-simplification);
J. Rossignac, P. Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993 (vertex clustering).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.layout import Array
from urdf.geometry.shape import Color, Faces

MAX_TRIANGLES = 4_000_000
"""Largest number of triangles of a file, and of a robot."""

WELD_DISTANCE_SHARE = 1e-6
"""Distance between vertices that count as one, as a part of the size of the mesh."""


@dataclass(frozen=True, eq=False)
class Triangles:
    """vertices (k, 3) [m]; faces (m, 3), counterclockwise from outside; color: None where none is given."""

    vertices: Array
    faces: Faces
    color: Color | None = None

    def __post_init__(self) -> None:
        self.vertices.setflags(write=False)
        self.faces.setflags(write=False)

    def scaled(self, scale: Array) -> Triangles:
        """Scaled along the three axes (3,). A mirrored mesh has its faces reversed: they stay counterclockwise."""
        if np.array_equal(scale, np.ones(3)):
            return self
        faces = self.faces[:, ::-1].copy() if np.prod(np.sign(scale)) < 0 else self.faces
        return Triangles(self.vertices * scale, faces, self.color)

    @property
    def size(self) -> float:
        """Longest side of the box around all vertices [m]; 0 without any."""
        return float(np.ptp(self.vertices, axis=0).max()) if len(self.vertices) else 0.0


def joined(parts: Sequence[Triangles]) -> Triangles:
    """All as one, with the color of the first."""
    if len(parts) == 1:
        return parts[0]
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [part.faces + start for part, start in zip(parts, starts, strict=False)]
    return Triangles(np.concatenate([part.vertices for part in parts]), np.concatenate(faces), parts[0].color)


def welded(part: Triangles) -> Triangles:
    """Vertices at the same place as one."""
    return clustered(part, part.size * WELD_DISTANCE_SHARE)


def clustered(part: Triangles, cell: float) -> Triangles:
    """The vertices in one cell of a grid become their mean; triangles that collapse, or occur twice, go."""
    used, corners = np.unique(part.faces, return_inverse=True)
    vertices, faces = part.vertices[used], corners.reshape(-1, 3)
    grid = np.floor((vertices - vertices.min(axis=0)) / (cell or 1.0) + 0.5).astype(np.int64)
    _, first, inverse = np.unique(_key(grid), return_index=True, return_inverse=True)
    count = np.bincount(inverse)
    middle = vertices[first]
    for k in range(3):  # offsets from one of them: vertices at the same place keep every bit
        middle[:, k] += np.bincount(inverse, vertices[:, k] - middle[inverse, k]) / count
    faces = inverse[faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(_key(np.sort(faces, axis=1)), return_index=True)
    faces = faces[np.sort(first)]
    used, corners = np.unique(faces, return_inverse=True)
    return Triangles(middle[used], corners.reshape(-1, 3).astype(np.int64), part.color)


def _key(rows: Faces) -> Faces:
    """One whole number per row of three that are not negative, the same for equal rows: sorted much faster."""
    if not len(rows):
        return np.zeros(0, dtype=np.int64)
    y, z = rows[:, 1].max() + 1, rows[:, 2].max() + 1
    _, pairs = np.unique(rows[:, 0] * y + rows[:, 1], return_inverse=True)
    key: Faces = pairs * z + rows[:, 2]
    return key


MIN_PART_FACES = 64
"""Faces that a part keeps at least, where it has them: fewer do not show its form."""

AGGRESSIVENESS = 7
"""Aggressiveness of fast-simplification, its default: how fast the tolerated error grows from pass to pass."""

MAX_FACE_EXCESS = 1.2
"""Part of the wanted number of faces that edge collapse may exceed, before vertices are clustered."""

CLUSTER_GRIDS = (256, 192, 128, 96, 64, 48, 32, 24, 16, 12, 8, 6, 4)
"""Cells along the longest side of the mesh into which vertices are clustered, until it has few enough faces."""


def shared_out(sizes: Sequence[int], faces: int | None) -> list[int]:
    """How many faces each part may have, of so many in all: in proportion, but none less than MIN_PART_FACES."""
    total = sum(sizes)
    if faces is None or total <= faces:
        return list(sizes)
    return [min(size, max(MIN_PART_FACES, faces * size // total)) for size in sizes]


def decimated(part: Triangles, faces: int) -> Triangles:
    """The part with about so many faces, if it has more."""
    if len(part.faces) <= faces:
        return part
    fewer = _collapsed(part, faces)
    for cells in CLUSTER_GRIDS:
        if len(fewer.faces) <= MAX_FACE_EXCESS * faces:
            break
        fewer = clustered(part, part.size / cells)
    return fewer


def _collapsed(part: Triangles, faces: int) -> Triangles:
    """Edge collapse, which stops early where a mesh is torn; the part as given where it is not installed."""
    try:
        from fast_simplification import simplify
    except ImportError:
        return part
    vertices, triangles = simplify(
        part.vertices.astype(np.float32), part.faces.astype(np.int32), target_count=faces, agg=AGGRESSIVENESS
    )
    return Triangles(np.array(vertices, dtype=float), np.array(triangles, dtype=np.int64), part.color)
