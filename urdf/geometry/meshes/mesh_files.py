"""Mesh files, found by the names in a URDF file, as triangles in meters. They are untrusted, and read within limits."""

from __future__ import annotations

import io
import logging
import os
import re
import stat
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from urdf.document.document import UNNAMED_SOURCES
from urdf.document.numbers import NUMBER, UNEXPANDED_EXPRESSION
from urdf.errors import shortened
from urdf.geometry.meshes.collada import read_collada
from urdf.geometry.meshes.triangles import Triangles, joined, welded
from urdf.geometry.shape import Color, UnreadableMesh

PACKAGE_SCHEMES = ("package", "model")
"""Schemes that begin with the name of a package: of ROS, of Gazebo."""


def find_mesh(name: str, document: Path) -> Path:
    """The file that a URDF file calls this.

    document: the URDF file, or one of UNNAMED_SOURCES

    package://NAME/REST is NAME/REST in a folder above the document, else REST in one of them (a package may lie in a
    folder of another name), else NAME/REST in a folder of ROS_PACKAGE_PATH or in share/ of one of AMENT_PREFIX_PATH,
    else the last part of REST beside the document.

    Raises UnreadableMesh, with the reason.
    """
    if not name.strip():
        raise UnreadableMesh("<mesh> has no file name")
    if UNEXPANDED_EXPRESSION.search(name):
        raise UnreadableMesh("the name is not expanded; expand the file with xacro")
    scheme, separator, rest = name.partition("://")
    candidates: Iterator[Path]
    if not separator:
        candidates = _beside(Path(name), document)
    elif scheme == "file":
        candidates = iter([Path(unquote("/" + rest.lstrip("/")))])
    elif scheme in PACKAGE_SCHEMES:
        candidates = _in_packages(rest.lstrip("/"), document)
    else:
        raise UnreadableMesh(f"{shortened(scheme)}:// is not fetched; save the file beside the URDF")
    reason = "no such file"
    for path in candidates:
        if os.path.isdir(path):  # unlike those of Path, it does not raise for impossible names
            reason = "it is a folder"
        elif os.path.exists(path):
            return path
    raise UnreadableMesh(reason)


def _beside(path: Path, document: Path) -> Iterator[Path]:
    if path.is_absolute():
        yield path
    elif document in UNNAMED_SOURCES:
        raise UnreadableMesh("the path is relative, and the URDF comes from no file; load it from its file")
    else:
        yield document.resolve().parent / path


def _in_packages(path: str, document: Path) -> Iterator[Path]:
    folders = [] if document in UNNAMED_SOURCES else [*document.resolve().parents]
    yield from (folder / path for folder in folders)
    within = path.partition("/")[2]
    yield from (folder / within for folder in folders if within)
    for variable, below in (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
        for folder in filter(None, os.environ.get(variable, "").split(os.pathsep)):
            yield Path(folder, below, path)
    yield from (folder / Path(path).name for folder in folders[:1])


MAX_MESH_BYTES = 100_000_000
"""Largest size of a mesh file [bytes]; the largest of published robots have some 30 MB."""

MAX_COLORS_BYTES = 1_000_000
"""Largest size of the .mtl file that an OBJ file names [bytes]."""

MAX_COORDINATE = 1e6
"""Largest coordinate that is drawn [m]."""

logging.getLogger("trimesh").addHandler(logging.NullHandler())  # else its messages are printed where nobody asked

STL_HEADER, STL_TRIANGLE = 84, 50
"""Bytes of the header and of a triangle in a binary STL file."""


def read_mesh(path: Path) -> tuple[Triangles, ...]:
    """The triangles of a file [m], those of one color together, with vertices at the same place as one.

    Raises UnreadableMesh: for a file that is none, too large or damaged, for NaN, for a mesh without triangles.
    """
    suffix = path.suffix.lower()
    if suffix not in _READERS:
        raise UnreadableMesh(f"'{shortened(suffix)}' files are not read, only {', '.join(_READERS)}")
    content = content_of(path, MAX_MESH_BYTES)
    try:
        parts = _READERS[suffix](content, path)
    except UnreadableMesh:
        raise
    except Exception as error:  # whatever the parsers stumble over
        raise UnreadableMesh(f"the file is damaged: {shortened(f'{type(error).__name__}: {error}')}") from error
    parts = [_checked(part) for part in parts if len(part.faces)]
    colors = dict.fromkeys(part.color for part in parts)
    whole = [welded(joined([part for part in parts if part.color == color])) for color in colors]
    if not any(len(part.faces) for part in whole):
        raise UnreadableMesh("the file has no triangles")
    return tuple(whole)


def content_of(path: Path, largest: int) -> bytes:
    """The bytes of a regular file. Raises UnreadableMesh, also for one that is larger than so many bytes."""
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise UnreadableMesh("not a regular file")
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except (OSError, ValueError) as error:
        raise UnreadableMesh(f"the file cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if len(content) > largest:
        raise UnreadableMesh(f"the file is larger than {largest // 1_000_000} MB; reduce the mesh")
    return content


def _stl(content: bytes, path: Path) -> list[Triangles]:
    from trimesh.exchange.stl import load_stl_binary

    if content.lstrip()[:5].lower() == b"solid" and b"facet" in content[:1000]:
        return _text_stl(content)
    if len(content) < STL_HEADER:
        raise UnreadableMesh("the file is truncated: shorter than the header of an STL file")
    number = int.from_bytes(content[STL_HEADER - 4 : STL_HEADER], "little")
    end = STL_HEADER + STL_TRIANGLE * number
    if len(content) < end:
        held = (len(content) - STL_HEADER) // STL_TRIANGLE
        raise UnreadableMesh(f"the file is truncated: {held} of {number} triangles")
    if content[end:].strip(b"\0"):
        raise UnreadableMesh(f"the file is damaged: {len(content) - end} bytes behind its {number} triangles")
    return _of_trimesh(load_stl_binary, io.BytesIO(content[:end]))


_COORDINATE = rf"(?:{NUMBER}|[-+]?(?i:nan|inf|infinity))"

_SOLID = re.compile(rb"\s*solid\b[^\r\n]*", re.IGNORECASE)
_END_OF_SOLID = re.compile(rb"\s*endsolid\b[^\r\n]*", re.IGNORECASE)
_FACET = re.compile(
    (
        r"\s*facet(?:\s+normal(?:\s+\S+){3})?\s+outer\s+loop"
        + rf"\s+vertex\s+({_COORDINATE})\s+({_COORDINATE})\s+({_COORDINATE})" * 3
        + r"\s+endloop\s+endfacet\b"
    ).encode(),
    re.IGNORECASE,
)


def _text_stl(content: bytes) -> list[Triangles]:
    """A triangle per facet: trimesh takes the numbers of all vertices in a row, so that a lost one moves the others."""
    position, corners = 0, list[tuple[bytes, ...]]()
    while solid := _SOLID.match(content, position):
        position = solid.end()
        while facet := _FACET.match(content, position):
            position = facet.end()
            corners.append(facet.groups())
        end = _END_OF_SOLID.match(content, position)
        if end is None:
            break
        position = end.end()
    rest = content[position:].lstrip()
    if rest:
        line = content.count(b"\n", 0, len(content) - len(rest)) + 1
        raise UnreadableMesh(f"the file is damaged: line {line} does not go on with a facet, or the end of the solid")
    vertices = np.array(corners, dtype=float).reshape(-1, 3)
    return [Triangles(vertices, np.arange(len(vertices)).reshape(-1, 3))]


_OBJ_WORDS = (
    "vt|vn|vp|l|p|g|s|o|mg|usemtl|mtllib|usemap|maplib|deg|bmat|step|cstype|curv2?|surf|parm|trim|hole|scrv|sp|end|con|"
    "bevel|c_interp|d_interp|lod|shadow_obj|trace_obj|ctech|stech|call|csh"
)
"""What a line of an OBJ file may begin with beside v and f (Wavefront, Advanced Visualizer Manual, Appendix B1)."""

_ODD_OBJ_LINE = re.compile(
    rf"^(?!(?:#.*|v(?:[ \t]+{_COORDINATE}){{3,}}[ \t]*(?:#.*)?|"
    rf"f(?:[ \t]+-?[1-9][0-9]*(?:/-?[0-9]*){{0,2}}){{3,}}[ \t]*(?:#.*)?|(?:{_OBJ_WORDS})(?:[ \t].*)?)?$).+$",
    re.MULTILINE,
)
"""A line that trimesh would pass over, or read as another vertex or triangle than is written."""


def _obj(content: bytes, path: Path) -> list[Triangles]:
    from trimesh.exchange.obj import load_obj

    text = re.sub("\r\n?", "\n", content.decode(errors="replace"))  # names may be in any encoding
    text = re.sub("^[ \t]+", "", text, flags=re.MULTILINE)  # trimesh passes over lines that are indented
    if odd := _ODD_OBJ_LINE.search(text.replace("\\\n", "  ")):
        line = text.count("\n", 0, odd.start()) + 1
        raise UnreadableMesh(f"the file is damaged: line {line}: '{shortened(odd[0])}'")
    return _of_trimesh(load_obj, io.StringIO(text), resolver=_Colors(path.parent))


_READERS: dict[str, Callable[[bytes, Path], list[Triangles]]] = {
    ".stl": _stl,
    ".obj": _obj,
    ".dae": lambda content, _: read_collada(content),
}


class _Colors:
    """What trimesh may read beside an OBJ file: small .mtl files of its folder, and no images."""

    def __init__(self, folder: Path):
        self.folder = folder

    def get(self, name: str) -> bytes:
        path = self.folder / Path(name.strip()).name
        if path.suffix.lower() != ".mtl":
            raise FileNotFoundError(name)
        try:
            return content_of(path, MAX_COLORS_BYTES)
        except UnreadableMesh as error:
            raise FileNotFoundError(name) from error

    __getitem__ = get


def _of_trimesh(reader: Any, file: Any, **options: Any) -> list[Triangles]:
    """What a reader of trimesh gives, without the class Trimesh, which drops vertices that are NaN."""
    from trimesh.geometry import triangulate_quads

    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        warnings.simplefilter("error", DeprecationWarning)  # NumPy's, of a text that is not all numbers
        found = reader(file, **options)
    return [
        Triangles(np.array(mesh["vertices"], dtype=float), np.array(triangulate_quads(mesh["faces"])), _color(mesh))
        for mesh in found.get("geometry", {"": found}).values()
        if len(mesh.get("faces", ()))
    ]


def _color(mesh: Any) -> Color | None:
    material = getattr(mesh.get("visual"), "material", None)
    if material is None or not hasattr(material, "diffuse") or material.diffuse is None:
        return None
    red, green, blue, opacity = (float(x) / 255 for x in material.main_color)
    return red, green, blue, opacity


def _checked(part: Triangles) -> Triangles:
    if part.vertices.shape[1:] != (3,) or part.faces.shape[1:] != (3,):
        raise UnreadableMesh("the file is damaged: vertices without three coordinates")
    if part.faces.min() < 0 or part.faces.max() >= len(part.vertices):
        raise UnreadableMesh("the file is damaged: a triangle names a vertex that is not there")
    used = part.vertices[part.faces.ravel()]
    if not np.isfinite(used).all():
        raise UnreadableMesh("a vertex has a coordinate that is NaN or infinite")
    if np.abs(used).max() > MAX_COORDINATE:
        raise UnreadableMesh(
            f"a vertex lies farther than {MAX_COORDINATE:g} m from the origin; check the unit of length"
        )
    return part
