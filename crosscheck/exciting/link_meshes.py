"""The shapes of a robot's links as triangles, one mesh per link."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

import urdf
from graphdyn import RobotModel
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
