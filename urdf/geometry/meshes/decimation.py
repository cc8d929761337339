"""Fewer triangles: quadric edge collapse where it succeeds, else vertices that lie close together become one.

M. Garland, P. Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH 1997 (fast-simplification);
J. Rossignac, P. Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993 (vertex clustering).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from urdf.geometry.meshes.triangles import Triangles, clustered

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
