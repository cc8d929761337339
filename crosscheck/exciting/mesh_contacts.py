"""The shapes of a robot's links as triangles, and whether those of two links touch, by coal, which Pinocchio brings.

Triangles against triangles, not convex hulls: hulls fill what a link leaves free beside it, so that links that are bent
around others would always collide. Triangles see no body that is wholly inside another; a motion that starts free gets
there only through the surface.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import coal
import numpy as np
from numpy.typing import ArrayLike, NDArray

import urdf
from graphdyn import RobotModel
from graphdyn.excitation import Poses
from graphdyn.layout import Array
from urdf import Reading


@dataclass(frozen=True, eq=False)
class LinkMesh:
    """All shapes of a link.

    body: number of the body that carries the link; 0 is the ground
    vertices: in link axes of the body                      (k, 3)  [m]
    faces: numbers of the vertices of each triangle         (m, 3)
    """

    link: str
    body: int
    vertices: Array
    faces: NDArray[np.int64]

    @cached_property
    def triangles(self) -> Array:
        """Corners (m, 3, 3) [m]."""
        return self.vertices[self.faces]


def link_meshes(source: str, model: RobotModel, reading: Reading) -> tuple[tuple[LinkMesh, ...], dict[str, str]]:
    """The links of which all shapes can be read, and why others cannot, by link.

    The collision shapes of a link are taken, its visual shapes where it has none that can be read. Links without shapes
    are in neither.
    """
    found: dict[str, LinkMesh] = {}
    missing: dict[str, str] = {}
    numbers = {name: number for number, name in enumerate((model.base_name, *model.body_names))}
    geometries: tuple[Literal["collision", "visual"], ...] = ("collision", "visual")
    for geometry in geometries:
        shapes = urdf.shapes(source, geometry=geometry, reading=reading)
        unread = {shape.link: f"{shape.file or 'a shape'}: {shape.reason}" for shape in shapes.missing}
        for link, reason in unread.items():
            missing.setdefault(link, reason)
        own: dict[str, list[urdf.Shape]] = {}
        for shape in shapes.meshes:
            if shape.link not in unread and shape.link not in found and len(shape.faces):
                own.setdefault(shape.link, []).append(shape)
        found |= {link: _joined(link, numbers[parts[0].body], parts) for link, parts in own.items()}
    return tuple(found.values()), {link: reason for link, reason in missing.items() if link not in found}


def _joined(link: str, body: int, parts: Sequence[urdf.Shape]) -> LinkMesh:
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    vertices = [part.vertices @ part.placement.rotation.T + part.placement.translation for part in parts]
    faces = [part.faces + start for part, start in zip(parts, starts, strict=True)]
    return LinkMesh(link, body, np.concatenate(vertices), np.concatenate(faces))


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
