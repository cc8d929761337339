"""The drawings of a robot as triangles; what cannot be read is listed with the reason."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from graphdyn import Placement
from urdf.document.elements import Drawing, Geometry
from urdf.document.source import Source
from urdf.geometry.drawn import MESH_KIND, Drawn, primitive, read_drawing
from urdf.geometry.meshes.mesh_files import find_mesh, read_mesh
from urdf.geometry.meshes.triangles import MAX_TRIANGLES, Triangles, decimated, shared_out
from urdf.geometry.shape import DEFAULT_COLOR, MissingShape, Shape, Shapes, UnreadableMesh

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
    """Reads every mesh file once, and no more triangles than MOST_TRIANGLES."""

    def __init__(self, source: Source):
        self.document = source.path
        self.bytes = self.triangles = 0
        self.files: dict[str, tuple[Triangles, ...] | UnreadableMesh] = {}
        self.scaled: dict[tuple[str, tuple[float, ...]], tuple[Triangles, ...]] = {}

    def parts(self, drawn: Drawn) -> tuple[Triangles, ...]:
        """Raises Unreadable."""
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
                self.files[name] = read_mesh(path)
            except UnreadableMesh as error:
                self.files[name] = error
        found = self.files[name]
        if isinstance(found, UnreadableMesh):
            raise found
        return found


def _at(drawing: Drawing, error: UnreadableMesh) -> str:
    return str(error) if drawing.line is None else f"line {drawing.line}: {error}"
