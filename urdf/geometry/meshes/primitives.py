"""Boxes, cylinders, spheres and capsules as triangles, centered at the origin, their axis along z."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from urdf.geometry.meshes.triangles import Triangles

CYLINDER_SECTIONS = 32
"""Sides of the prism that a cylinder is drawn as: its radius is short by at most 0.5 %."""

SPHERE_SUBDIVISIONS = 2
"""Number of subdivisions of the icosahedron that a sphere is drawn as: 320 faces."""

PRIMITIVE_SIZES: Mapping[str, Mapping[str, int]] = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "capsule": {"radius": 1, "length": 1},
}
"""Per element its attributes, and how many numbers each holds [m]."""


def primitive(kind: str, *sizes: float) -> Triangles:
    """The element with these sizes [m], in the order of PRIMITIVE_SIZES."""
    mesh = _MAKERS[kind](*sizes)
    return Triangles(np.array(mesh.vertices, dtype=float), np.array(mesh.faces))


def _box(x: float, y: float, z: float) -> Any:
    from trimesh import creation

    return creation.box((x, y, z))


def _cylinder(radius: float, length: float) -> Any:
    from trimesh import creation

    return creation.cylinder(radius, length, sections=CYLINDER_SECTIONS)


def _sphere(radius: float) -> Any:
    from trimesh import creation

    return creation.icosphere(SPHERE_SUBDIVISIONS, radius)


def _capsule(radius: float, length: float) -> Any:
    from trimesh import creation

    return creation.capsule(length, radius, count=(CYLINDER_SECTIONS // 2, CYLINDER_SECTIONS))


_MAKERS: Mapping[str, Callable[..., Any]] = {
    "box": _box,
    "cylinder": _cylinder,
    "sphere": _sphere,
    "capsule": _capsule,
}
