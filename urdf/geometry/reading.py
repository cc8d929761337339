"""The drawings of a robot as numbers and as triangles; what cannot be read is listed with the reason."""

from __future__ import annotations

import logging
import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
from lxml import etree

from graphdyn import Placement
from urdf.document.elements import Drawing, Geometry, children, line_said, name_of, tag_of
from urdf.document.numbers import BadNumber, numbers, rotation_from_rpy
from urdf.document.source import Source
from urdf.errors import shortened
from urdf.geometry.meshes.mesh_files import MAX_COORDINATE, find_mesh, read_mesh
from urdf.geometry.meshes.triangles import MAX_TRIANGLES, Triangles, decimated, shared_out
from urdf.geometry.shape import DEFAULT_COLOR, Color, MissingShape, Shape, Shapes, UnreadableMesh

log = logging.getLogger(__name__)

MESH_KIND = "mesh"

PRIMITIVE_SIZES: Mapping[str, Mapping[str, int]] = {
    "box": {"size": 3},
    "cylinder": {"radius": 1, "length": 1},
    "sphere": {"radius": 1},
    "capsule": {"radius": 1, "length": 1},
}
"""Per element its attributes, and how many numbers each holds [m]."""

CYLINDER_SECTIONS = 32
"""Sides of the prism that a cylinder is drawn as: its radius is short by at most 0.5 %."""

SPHERE_SUBDIVISIONS = 2
"""Number of subdivisions of the icosahedron that a sphere is drawn as: 320 faces."""


@dataclass(frozen=True)
class Drawn:
    """What a drawing is, and where.

    kind: of the element: "box", "cylinder", "sphere", "capsule" or "mesh"
    sizes: its numbers in the order of PRIMITIVE_SIZES [m]; of a mesh its scale
    placement: in the frame of its link
    color: of its material; None without one
    file: of a mesh, as the URDF names it
    """

    kind: str
    sizes: tuple[float, ...]
    placement: Placement
    color: Color | None
    file: str | None = None


def read_drawing(drawing: Drawing, materials: Mapping[str, etree._Element]) -> Drawn:
    """The element as numbers; materials: of the robot, by name. Raises UnreadableMesh with what is wrong in it."""
    geometry = next(children(drawing.element, "geometry"), None)
    if geometry is None:
        raise UnreadableMesh(f"<{drawing.geometry}> has no <geometry>")
    inside = [child for child in geometry if tag_of(child)]
    if len(inside) != 1:
        raise UnreadableMesh(f"<geometry> has {len(inside)} elements, expected one")
    (element,) = inside
    kind = tag_of(element)
    placement, color = _placement(drawing.element), _color(drawing.element, materials)
    if kind == MESH_KIND:
        scale = _numbers(element, "scale", 3, (1.0, 1.0, 1.0))
        if not np.all(scale):
            raise UnreadableMesh(f'scale="{shortened(element.get("scale", ""))}": a scale of zero')
        return Drawn(kind, scale, placement, color, element.get("filename", ""))
    if kind not in PRIMITIVE_SIZES:
        raise UnreadableMesh(
            f"<{shortened(kind)}> is none of {', '.join(f'<{name}>' for name in (*PRIMITIVE_SIZES, MESH_KIND))}"
        )
    sizes = tuple(x for name, count in PRIMITIVE_SIZES[kind].items() for x in _numbers(element, name, count))
    if min(sizes) <= 0:
        raise UnreadableMesh(f"<{kind}>: a size that is not positive")
    return Drawn(kind, sizes, placement, color)


def primitive(kind: str, *sizes: float) -> Triangles:
    """An element with these sizes [m], in the order of PRIMITIVE_SIZES, centered at the origin, its axis along z."""
    from trimesh import creation

    if kind == "box":
        mesh = creation.box(sizes)
    elif kind == "cylinder":
        mesh = creation.cylinder(sizes[0], sizes[1], sections=CYLINDER_SECTIONS)
    elif kind == "sphere":
        mesh = creation.icosphere(SPHERE_SUBDIVISIONS, *sizes)
    else:
        mesh = creation.capsule(sizes[1], sizes[0], count=(CYLINDER_SECTIONS // 2, CYLINDER_SECTIONS))
    return Triangles(np.array(mesh.vertices, dtype=float), np.array(mesh.faces))


def _numbers(
    element: etree._Element, name: str, count: int, default: tuple[float, ...] | None = None
) -> tuple[float, ...]:
    text = element.get(name)
    if text is None:
        if default is None:
            raise UnreadableMesh(f"<{tag_of(element)}>: attribute '{name}' is missing")
        return default
    found = numbers(text, count, f'{name}="{shortened(text)}"')
    if isinstance(found, BadNumber):
        raise UnreadableMesh(f"<{tag_of(element)}>: {found.problem}; {found.remedy}")
    if max(map(abs, found)) > MAX_COORDINATE:
        raise UnreadableMesh(
            f'<{tag_of(element)}>: {name}="{shortened(text)}" is larger than {MAX_COORDINATE:g}; give meters'
        )
    return tuple(found)


def _placement(element: etree._Element) -> Placement:
    origin = next(children(element, "origin"), None)
    if origin is None:
        return Placement()
    zero = (0.0, 0.0, 0.0)
    xyz, rpy = _numbers(origin, "xyz", 3, zero), _numbers(origin, "rpy", 3, zero)
    return Placement(rotation_from_rpy(*rpy), np.array(xyz))


def _color(element: etree._Element, materials: Mapping[str, etree._Element]) -> Color | None:
    """None without a material, and where it has no valid color: that hides no shape."""
    material = next(children(element, "material"), None)
    if material is None:
        return None
    for place in (material, materials.get(name_of(material))):
        color = None if place is None else next(children(place, "color"), None)
        text = "" if color is None else color.get("rgba", "")
        found = numbers(text, 4, "")
        if not isinstance(found, BadNumber):
            red, green, blue, opacity = np.clip(found, 0.0, 1.0).tolist()
            return red, green, blue, opacity
    return None


MAX_MESH_FILES_BYTES = 500_000_000
"""Largest size of all mesh files of a robot; those of the largest published robots have some 100 MB."""


@dataclass(frozen=True, eq=False)
class Solid:
    """A drawing of a link and its triangles, in the axes of the drawing; parts: one per color."""

    link: str
    drawn: Drawn
    parts: tuple[Triangles, ...]


def placed_shapes(
    source: Source, geometry: Geometry, places: Mapping[str, tuple[str, Placement]], faces: int | None
) -> Shapes:
    """The shapes of some links. places: per link, the body that carries it and its placement in that body's frame"""
    solids, missing = read_solids(source, geometry, places)
    parts = [(solid, part) for solid in solids for part in solid.parts]
    fewer: dict[tuple[int, int], Triangles] = {}  # of a part that occurs several times, once
    meshes = []
    for (solid, part), size in zip(parts, shared_out([len(part.faces) for _, part in parts], faces), strict=True):
        body, place = places[solid.link]
        key = id(part), size
        less = fewer[key] if key in fewer else fewer.setdefault(key, decimated(part, size))
        color = part.color or solid.drawn.color or DEFAULT_COLOR  # a mesh file's own colors come first, as in RViz
        placement = place @ solid.drawn.placement
        meshes.append(Shape(body, solid.link, placement, less.vertices, less.faces, color, solid.drawn.file))
    return Shapes(tuple(meshes), tuple(missing))


def read_solids(source: Source, geometry: Geometry, links: Collection[str]) -> tuple[list[Solid], list[MissingShape]]:
    """The solids of these links in the order of the file, and what cannot be read."""
    solids: list[Solid] = []
    missing: list[MissingShape] = []
    reader = _MeshReader(source)
    for drawing in source.drawings.drawings:
        if drawing.geometry != geometry or drawing.link not in links:
            continue
        file = None
        try:
            drawn = read_drawing(drawing, source.drawings.materials)
            file = drawn.file
            solids.append(Solid(drawing.link, drawn, reader.parts(drawn)))
        except UnreadableMesh as error:
            missing.append(MissingShape(drawing.link, file, _at(drawing, error)))
    return solids, missing


class _MeshReader:
    """Reads every mesh file once, and no more triangles than MAX_TRIANGLES."""

    def __init__(self, source: Source):
        self.document = source.path
        self.bytes = self.triangles = 0
        self.files: dict[str, tuple[Triangles, ...] | UnreadableMesh] = {}
        self.scaled: dict[tuple[str, tuple[float, ...]], tuple[Triangles, ...]] = {}

    def parts(self, drawn: Drawn) -> tuple[Triangles, ...]:
        """Raises UnreadableMesh."""
        if drawn.kind != MESH_KIND or drawn.file is None:
            parts: tuple[Triangles, ...] = (primitive(drawn.kind, *drawn.sizes),)
        else:
            parts = self._file(drawn.file)
        number = sum(len(part.faces) for part in parts)
        if self.triangles + number > MAX_TRIANGLES:
            raise UnreadableMesh(f"with it, the robot has more than {MAX_TRIANGLES} triangles; reduce the meshes")
        self.triangles += number
        if drawn.file is None:
            return parts
        key = drawn.file, drawn.sizes
        if key not in self.scaled:
            self.scaled[key] = tuple(part.scaled(np.array(drawn.sizes)) for part in parts)
        return self.scaled[key]

    def _file(self, name: str) -> tuple[Triangles, ...]:
        if name not in self.files:
            try:
                path = find_mesh(name, self.document)
                self.bytes += os.path.getsize(path)
                if self.bytes > MAX_MESH_FILES_BYTES:
                    raise UnreadableMesh(
                        f"with it, the meshes have more than {MAX_MESH_FILES_BYTES // 1_000_000} MB; reduce them"
                    )
                log.info("reading %s", os.path.basename(path))
                self.files[name] = read_mesh(path)
            except UnreadableMesh as error:
                self.files[name] = error
        found = self.files[name]
        if isinstance(found, UnreadableMesh):
            raise found
        return found


def _at(drawing: Drawing, error: UnreadableMesh) -> str:
    return str(error) if drawing.line is None else f"{line_said(drawing.element)}: {error}"
