"""Fewer triangles: quadric edge collapse where it succeeds, else vertices that lie close together become one.

M. Garland, P. Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH 1997 (fast-simplification);
J. Rossignac, P. Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993 (vertex clustering).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from graphdyn.layout import Array
from urdf.geometry.shape import Faces
from urdf.geometry.triangles import Triangles

FEWEST = 64
"""Faces that a part keeps at least, where it has them: fewer do not show its form."""

AGGRESSIVENESS = 7
"""Of fast-simplification, its default: how fast the tolerated error grows from pass to pass."""

ABOVE = 1.2
"""Part of the wanted number of faces that edge collapse may exceed, before vertices are clustered."""

WELD = 1e-5
"""Distance between vertices that count as one, as a part of the size of the mesh."""

GRIDS = (256, 192, 128, 96, 64, 48, 32, 24, 16, 12, 8)
"""Cells along the longest side of the mesh into which vertices are clustered, until it has few enough faces."""


def shared_out(sizes: Sequence[int], faces: int | None) -> list[int]:
    """How many faces each part may have, of so many in all: in proportion, but none less than FEWEST."""
    total = sum(sizes)
    if faces is None or total <= faces:
        return list(sizes)
    return [min(size, max(FEWEST, faces * size // total)) for size in sizes]


def decimated(part: Triangles, faces: int) -> Triangles:
    """The part with about so many faces, if it has more."""
    if len(part.faces) <= faces:
        return part
    size = float(np.ptp(part.vertices, axis=0).max()) or 1.0
    welded = _clustered(part.vertices, part.faces, size * WELD)
    vertices, triangles = _collapsed(*welded, faces)
    for cells in GRIDS:
        if len(triangles) <= ABOVE * faces:
            break
        vertices, triangles = _clustered(*welded, size / cells)
    return Triangles(vertices, triangles, part.color)


def _collapsed(vertices: Array, triangles: Faces, faces: int) -> tuple[Array, Faces]:
    """Edge collapse; it stops early where a mesh is torn into many parts. As given, where it is not installed."""
    if len(triangles) <= faces:
        return vertices, triangles
    try:
        from fast_simplification import simplify
    except ImportError:
        return vertices, triangles
    fewer, faces_ = simplify(
        vertices.astype(np.float32),
        triangles.astype(np.int32),
        target_count=faces,
        agg=AGGRESSIVENESS,
    )
    return np.asarray(fewer, dtype=float), np.asarray(faces_, dtype=np.int64)


def _clustered(vertices: Array, triangles: Faces, cell: float) -> tuple[Array, Faces]:
    """Vertices in one cell of a grid become their mean; triangles that collapse, or occur twice, go."""
    grid = np.floor((vertices - vertices.min(axis=0)) / cell + 0.5).astype(np.int64)
    _, inverse = np.unique(grid, axis=0, return_inverse=True)
    inverse = inverse.ravel()
    count = np.bincount(inverse)
    mean = np.stack([np.bincount(inverse, vertices[:, k]) / count for k in range(3)], axis=1)
    triangles = inverse[triangles]
    a, b, c = triangles.T
    triangles = triangles[(a != b) & (b != c) & (c != a)]
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    triangles = triangles[np.sort(first)]
    used, inverse = np.unique(triangles, return_inverse=True)
    return mean[used], inverse.reshape(-1, 3).astype(np.int64)
