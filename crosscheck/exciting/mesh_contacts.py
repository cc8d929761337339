"""Whether the meshes of two links touch: the only file that imports coal, which comes with Pinocchio.

Triangles against triangles, not convex hulls: hulls fill what a link leaves free beside it, so that links that are bent
around others would always collide. Triangles see no body that is wholly inside another; a motion that starts free gets
there only through the surface.
"""

from __future__ import annotations

from collections.abc import Sequence

import coal
import numpy as np
from numpy.typing import ArrayLike, NDArray

from crosscheck.exciting.link_meshes import LinkMesh
from graphdyn.excitation import Poses
from graphdyn.layout import Array

Pair = tuple[int, int]
"""Numbers of two links among the meshes."""


class MeshContacts:
    """The meshes of a robot, in trees of boxes (Pan, Chitta, Manocha, "FCL", ICRA 2012)."""

    def __init__(self, meshes: Sequence[LinkMesh]) -> None:
        self._bodies = [mesh.body for mesh in meshes]
        self._trees = [_tree(mesh) for mesh in meshes]

    def touching(self, pairs: Sequence[Pair], poses: Poses, margins: ArrayLike) -> NDArray[np.bool_]:
        """Which pairs are nearer than their margin [m], or touch, in each pose (N, pairs)."""
        at = {body: _placements(*poses.of_body(body)) for body in {self._bodies[k] for pair in pairs for k in pair}}
        request, result = coal.CollisionRequest(), coal.CollisionResult()
        found = np.zeros((len(poses), len(pairs)), dtype=bool)
        for column, ((one, other), margin) in enumerate(zip(pairs, np.asarray(margins).tolist(), strict=True)):
            request.security_margin = margin
            tree, other_tree = self._trees[one], self._trees[other]
            where = zip(at[self._bodies[one]], at[self._bodies[other]], strict=True)
            for row, (place, other_place) in enumerate(where):
                result.clear()
                found[row, column] = coal.collide(tree, place, other_tree, other_place, request, result) > 0
        return found


def _tree(mesh: LinkMesh) -> coal.BVHModelOBBRSS:
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(mesh.faces), len(mesh.vertices))
    for a, b, c in mesh.triangles:
        tree.addTriangle(a, b, c)
    tree.endModel()
    return tree


def _placements(rotation: Array, position: Array) -> list[coal.Transform3s]:
    return [coal.Transform3s(turned, at) for turned, at in zip(rotation, position, strict=True)]
