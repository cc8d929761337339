"""Collada files (.dae) as triangles: the geometry that their scene shows, with its diffuse colors.

Khronos Group, "COLLADA – Digital Asset Schema Release 1.4.1", 2008. Written here because the reader that trimesh uses
leaves out geometry whose texture is missing, which the meshes of published robots often have.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from graphdyn.layout import Array
from graphdyn.model import rotation_about
from urdf.errors import shortened
from urdf.geometry.meshes.triangles import MAX_TRIANGLES, Triangles
from urdf.geometry.shape import Color, Faces, UnreadableMesh

_ENCODING = re.compile(rb"""<\?xml[^>]*encoding\s*=\s*["']([^"']*)["']""")
_ASCII_COMPATIBLE = (b"utf-8", b"utf8", b"us-ascii", b"ascii", b"iso-8859-1", b"iso-8859-15", b"windows-1252")
"""Encodings in which the bytes "<!DOCTYPE" can be found."""


class ColladaDocument:
    """The root element and the elements by their id. The file is untrusted: nothing in it expands.

    Raises UnreadableMesh for what is no Collada file.
    """

    def __init__(self, content: bytes):
        encoding = _ENCODING.search(content[:200])
        if encoding is not None and encoding.group(1).lower() not in _ASCII_COMPATIBLE:
            raise UnreadableMesh("the file is not in UTF-8; save it so")
        if not content.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<"):
            raise UnreadableMesh("the file is damaged: not XML in UTF-8")
        if b"<!DOCTYPE" in content:
            raise UnreadableMesh("the file has a document type declaration; remove <!DOCTYPE …>")
        # huge_tree: a mesh of 100,000 vertices is a text beyond libxml2's usual limit
        parser = etree.XMLParser(
            resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True, remove_comments=True
        )
        try:
            self.root = etree.fromstring(content, parser)
        except etree.XMLSyntaxError as error:
            raise UnreadableMesh(f"the file is damaged: {shortened(str(error.msg))}") from error
        name = etree.QName(self.root).localname
        if name != "COLLADA":
            raise UnreadableMesh(f"the root element is <{shortened(name)}>, not <COLLADA>")
        self._by_id = {element.get("id"): element for element in self.root.iterfind(".//*[@id]")}

    def target(self, element: etree._Element, attribute: str = "url") -> etree._Element:
        """What an attribute such as url="#part" refers to."""
        text = element.get(attribute, "")
        found = self._by_id.get(text.removeprefix("#")) if text.startswith("#") else None
        if found is None:
            raise UnreadableMesh(f'the file is damaged: {attribute}="{shortened(text)}" refers to nothing in it')
        return found

    def unit(self) -> float:
        """The length of its unit [m]; 1 where it says nothing."""
        element = self.root.find("./{*}asset/{*}unit")
        text = "1" if element is None else element.get("meter", "1")
        try:
            length = float(text)
        except ValueError:
            length = math.nan
        if not (math.isfinite(length) and length > 0):
            raise UnreadableMesh(f'<unit meter="{shortened(text)}"> is not a length')
        return length


def _numbers(element: etree._Element | None, kind: Any = np.float64) -> NDArray[Any]:
    """The numbers in its text."""
    if element is None or not (element.text or "").strip():
        return np.zeros(0, dtype=kind)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # of a text that is not all numbers
        try:
            found = np.fromstring(element.text or "", dtype=kind, sep=" ")
        except (DeprecationWarning, ValueError) as error:
            raise UnreadableMesh(f"the file is damaged: <{tag(element)}> holds something that is no number") from error
    _check_count(element, len(found), "numbers")
    return found


def _check_count(element: etree._Element, found: int, what: str) -> None:
    """Raises UnreadableMesh where an element states another number of its parts than it has."""
    if element.get("count") is not None and _count(element, "count", 0) != found:
        stated = shortened(element.get("count", ""))
        raise UnreadableMesh(f'the file is damaged: <{tag(element)} count="{stated}"> has {found} {what}')


def tag(element: etree._Element) -> str:
    return etree.QName(element).localname


MAX_NODES, MAX_DEPTH = 20_000, 100
"""Largest number of nodes of a scene, those that it shows several times counted as often; largest depth of them."""


def read_collada(content: bytes) -> list[Triangles]:
    """The triangles of the scene [m], in the axes of the file: <up_axis> is left aside, as in RViz and Pinocchio.

    Raises UnreadableMesh.
    """
    return _ColladaScene(ColladaDocument(content)).triangles()


class _ColladaScene:
    """What a document shows. Geometry and materials are read once."""

    def __init__(self, document: ColladaDocument):
        self.document = document
        self.geometries: dict[etree._Element, list[tuple[str, Array, Faces]]] = {}
        self.nodes = self.faces = 0

    def triangles(self) -> list[Triangles]:
        shown = self.document.root.find("./{*}scene/{*}instance_visual_scene")
        if shown is None:
            raise UnreadableMesh("the file has no <scene>; export it with one")
        unit = np.diag([*[self.document.unit()] * 3, 1.0])
        return [
            part for node in self.document.target(shown).iterchildren("{*}node") for part in self._node(node, unit, 0)
        ]

    def _node(self, node: etree._Element, outside: Array, depth: int) -> Iterator[Triangles]:
        self.nodes += 1
        if self.nodes > MAX_NODES or depth > MAX_DEPTH:
            raise UnreadableMesh(f"the scene has more than {MAX_NODES} nodes, or more than {MAX_DEPTH} in each other")
        matrix = outside
        for element in node.iterchildren(etree.Element):
            kind = tag(element)
            if kind in _TRANSFORMS:
                matrix = matrix @ _transform(element)
            elif kind == "node":
                yield from self._node(element, matrix, depth + 1)
            elif kind == "instance_node":
                yield from self._node(self.document.target(element), matrix, depth + 1)
            elif kind == "instance_geometry":
                yield from self._instance(element, matrix)
            elif kind in ("instance_controller", "lookat", "skew"):
                raise UnreadableMesh(f"<{kind}> is not read; export the mesh without it")

    def _instance(self, element: etree._Element, matrix: Array) -> Iterator[Triangles]:
        geometry = self.document.target(element)
        if geometry not in self.geometries:
            self.geometries[geometry] = list(self._geometry(geometry))
        rotation, translation = matrix[:3, :3], matrix[:3, 3]
        mirrored = np.linalg.det(rotation) < 0
        for material, vertices, faces in self.geometries[geometry]:
            self.faces += len(faces)
            if self.faces > MAX_TRIANGLES:
                raise UnreadableMesh(f"the scene has more than {MAX_TRIANGLES} triangles; reduce the mesh")
            turned = faces[:, ::-1] if mirrored else faces
            yield Triangles(vertices @ rotation.T + translation, turned.copy(), self._color(element, material))

    def _geometry(self, geometry: etree._Element) -> Iterator[tuple[str, Array, Faces]]:
        """Material, vertices and faces of its parts."""
        mesh = geometry.find("./{*}mesh")
        if mesh is None:
            raise UnreadableMesh("a <geometry> without <mesh> is not read; export it as triangles")
        for part in mesh.iterchildren(etree.Element):
            kind = tag(part)
            if kind in _FACES:
                vertices, faces = self._positions(part), _FACES[kind](part)
                if len(faces) and (faces.min() < 0 or faces.max() >= len(vertices)):
                    raise UnreadableMesh("the file is damaged: a triangle names a vertex that is not there")
                yield part.get("material", ""), vertices, faces
            elif kind in ("tristrips", "trifans"):
                raise UnreadableMesh(f"<{kind}> are not read; export the mesh as triangles")

    def _positions(self, part: etree._Element) -> Array:
        """(k, 3), in the unit of the file."""
        vertices = self.document.target(_input(part, "VERTEX"), "source")
        source = self.document.target(_input(vertices, "POSITION"), "source")
        numbers = _numbers(source.find("./{*}float_array"))
        accessor = source.find("./{*}technique_common/{*}accessor")
        stride, offset = (3, 0) if accessor is None else (_count(accessor, "stride", 3), _count(accessor, "offset", 0))
        rows = numbers[offset:]
        if stride < 3 or len(rows) % stride:
            raise UnreadableMesh("the file is damaged: a source of positions that is not three numbers each")
        return rows.reshape(-1, stride)[:, :3]

    def _color(self, instance: etree._Element, symbol: str) -> Color | None:
        """Diffuse color of the material that an instance binds to a symbol; None for textures and gaps."""
        try:
            bound = instance.iterfind(".//{*}instance_material")
            binding = next(each for each in bound if each.get("symbol") == symbol)
            material = self.document.target(binding, "target")
            effect = self.document.target(next(material.iterfind("./{*}instance_effect")))
            color = _numbers(next(effect.iterfind(".//{*}diffuse/{*}color")))
        except (StopIteration, UnreadableMesh):
            return None
        if len(color) not in (3, 4) or not np.isfinite(color).all():
            return None
        red, green, blue, *opacity = np.clip(color, 0.0, 1.0).tolist()
        return red, green, blue, (opacity[0] if opacity else 0.0) or 1.0  # some exporters write 0 for opaque


def _transform(element: etree._Element) -> Array:
    """(4, 4)."""
    kind = tag(element)
    numbers = _numbers(element)
    if len(numbers) != _TRANSFORMS[kind] or not np.isfinite(numbers).all():
        raise UnreadableMesh(f"the file is damaged: <{kind}> does not hold {_TRANSFORMS[kind]} finite numbers")
    matrix = np.eye(4)
    if kind == "matrix":
        matrix = numbers.reshape(4, 4)
    elif kind == "translate":
        matrix[:3, 3] = numbers
    elif kind == "scale":
        matrix[:3, :3] = np.diag(numbers)
    elif numbers[:3].any():
        matrix[:3, :3] = rotation_about(numbers[:3] / np.linalg.norm(numbers[:3]), np.deg2rad(numbers[3]))
    return matrix


_TRANSFORMS = {"matrix": 16, "translate": 3, "rotate": 4, "scale": 3}
"""Elements that place a node, and how many numbers they hold."""


def _input(element: etree._Element, semantic: str) -> etree._Element:
    for each in element.iterchildren("{*}input"):
        if each.get("semantic") == semantic:
            return each
    raise UnreadableMesh(f"the file is damaged: <{tag(element)}> has no input {semantic}")


def _count(element: etree._Element, name: str, default: int) -> int:
    text = element.get(name, str(default)).strip()
    if not (text.isascii() and text.isdigit() and len(text) < 9):
        raise UnreadableMesh(f"the file is damaged: {name} of <{tag(element)}> is no number")
    return int(text)


def _corners(part: etree._Element, p: etree._Element) -> Faces:
    """Numbers of the vertices at the corners of the polygons (k,), without those of normals and textures."""
    stride = 1 + max(_count(each, "offset", 0) for each in part.iterchildren("{*}input"))
    numbers = _numbers(p, np.int64)
    if len(numbers) % stride:
        raise UnreadableMesh(f"the file is damaged: <p> of <{tag(part)}> ends within a corner")
    return numbers.reshape(-1, stride)[:, _count(_input(part, "VERTEX"), "offset", 0)]


def _triangles(part: etree._Element) -> Faces:
    corners = [_corners(part, p) for p in part.iterchildren("{*}p")]
    whole = np.concatenate([np.zeros(0, dtype=np.int64), *corners])
    if len(whole) % 3:
        raise UnreadableMesh("the file is damaged: <triangles> with a corner too many")
    _check_count(part, len(whole) // 3, "triangles")
    return whole.reshape(-1, 3)


def _polylist(part: etree._Element) -> Faces:
    counts = _numbers(part.find("./{*}vcount"), np.int64)
    p = part.find("./{*}p")
    corners = np.zeros(0, dtype=np.int64) if p is None else _corners(part, p)
    if (counts < 3).any() or counts.sum() != len(corners):
        raise UnreadableMesh("the file is damaged: <polylist> whose <vcount> does not fit its <p>")
    _check_count(part, len(counts), "polygons")
    return _fans(corners, counts)


def _polygons(part: etree._Element) -> Faces:
    if part.find("./{*}ph") is not None:
        raise UnreadableMesh("polygons with holes are not read; export the mesh as triangles")
    corners = [_corners(part, p) for p in part.iterchildren("{*}p")]
    counts = np.array([len(each) for each in corners], dtype=np.int64)
    if (counts < 3).any():
        raise UnreadableMesh("the file is damaged: a polygon with fewer than three corners")
    _check_count(part, len(counts), "polygons")
    return _fans(np.concatenate([np.zeros(0, dtype=np.int64), *corners]), counts)


def _fans(corners: Faces, counts: Faces) -> Faces:
    """Each polygon as triangles from its first corner."""
    first = np.cumsum(counts) - counts
    per_polygon = counts - 2
    polygon = np.repeat(np.arange(len(counts)), per_polygon)
    step = np.arange(per_polygon.sum()) - np.repeat(np.cumsum(per_polygon) - per_polygon, per_polygon)
    start = first[polygon]
    return np.stack([corners[start], corners[start + step + 1], corners[start + step + 2]], axis=1)


_FACES = {"triangles": _triangles, "polylist": _polylist, "polygons": _polygons}
"""Parts of a geometry that are read."""
