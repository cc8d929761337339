"""Mesh files, read as triangles in metres. Files are foreign: every one is read within limits of size."""

from __future__ import annotations

import io
import stat
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from urdf._wording import shortened
from urdf.geometry.collada import check_collada
from urdf.geometry.errors import Unreadable
from urdf.geometry.shape import Color
from urdf.geometry.triangles import Triangles, joined

SUFFIXES = (".stl", ".obj", ".dae")

LARGEST_MESH = 100_000_000
"""Largest size of a mesh file [bytes]; the largest of published robots have some 30 MB."""

LARGEST_MATERIALS = 1_000_000
"""Largest size of the file of colors that an OBJ file names [bytes]."""

LONGEST = 1e6
"""Largest coordinate that is drawn [m]."""

STL_HEADER, STL_TRIANGLE = 84, 50
"""Bytes of the header and of a triangle in a binary STL file."""


def read_mesh(path: Path) -> tuple[Triangles, ...]:
    """The triangles of a file [m], those of one color together.

    The up_axis of a Collada file is left aside, as RViz and Pinocchio do: the axes of the file are those of the link.

    Raises Unreadable: for a file that is none, too large or damaged, for NaN, for a mesh without triangles.
    """
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise Unreadable(f"'{shortened(suffix)}' files are not read, only {', '.join(SUFFIXES)}")
    content = _content(path, LARGEST_MESH)
    unit = 1.0
    if suffix == ".stl":
        content = _checked_stl(content)
    elif suffix == ".dae":
        unit = check_collada(content, LARGEST_MESH)
    parts = [_triangles(mesh, unit) for mesh in _parsed(path, content)]
    whole = _by_color([part for part in parts if len(part.faces)])
    if not whole:
        raise Unreadable("the file has no triangles")
    return whole


def _content(path: Path, largest: int) -> bytes:
    try:
        if not stat.S_ISREG(path.stat().st_mode):
            raise Unreadable("not a regular file")
        with path.open("rb") as file:
            content = file.read(largest + 1)
    except (OSError, ValueError) as error:
        raise Unreadable(f"the file cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if len(content) > largest:
        raise Unreadable(f"the file is larger than {largest // 1_000_000} MB; reduce the mesh")
    return content


def _checked_stl(content: bytes) -> bytes:
    """The content without what follows the last triangle of a binary file."""
    if content.lstrip()[:5].lower() == b"solid" and b"facet" in content[:1000]:
        return content
    if len(content) < STL_HEADER:
        raise Unreadable("the file is shorter than the header of an STL file")
    number = int.from_bytes(content[80:84], "little")
    end = STL_HEADER + STL_TRIANGLE * number
    if len(content) < end:
        held = (len(content) - STL_HEADER) // STL_TRIANGLE
        raise Unreadable(f"the file is truncated: it holds {held} of the {number} triangles in its header")
    return content[:end]


class _Materials:
    """What trimesh may read beside an OBJ file: small .mtl files in its folder."""

    def __init__(self, folder: Path):
        self.folder = folder

    def get(self, name: str) -> bytes:
        path = self.folder / Path(name.strip()).name
        if path.suffix.lower() != ".mtl":
            raise FileNotFoundError(name)
        try:
            return _content(path, LARGEST_MATERIALS)
        except Unreadable as error:
            raise FileNotFoundError(name) from error

    __getitem__ = get


def _parsed(path: Path, content: bytes) -> list[Any]:
    """The meshes of a file, in its axes and unit. Raises Unreadable, whatever the parser stumbles over."""
    import trimesh

    suffix = path.suffix.lower()
    resolver: Any = _Materials(path.parent)
    text = suffix == ".obj"
    file = io.StringIO(content.decode(errors="replace")) if text else io.BytesIO(content)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            # NumPy's warning of numbers that are cut off in the middle: what follows them would be left out.
            warnings.simplefilter("error", DeprecationWarning)
            scene = trimesh.load_scene(file, file_type=suffix[1:], resolver=resolver, process=False)
            return [mesh for mesh in scene.dump() if isinstance(mesh, trimesh.Trimesh)]
    except ImportError as error:
        raise Unreadable(f"a {suffix} file needs pycollada; pip install 'graphdyn[view]'") from error
    except Exception as error:
        raise Unreadable(f"the file is damaged: {shortened(f'{type(error).__name__}: {error}')}") from error


def _triangles(mesh: Any, unit: float) -> Triangles:
    vertices, faces = np.array(mesh.vertices, dtype=float) * unit, np.array(mesh.faces, dtype=np.int64)
    if not len(faces):
        return Triangles(vertices, faces)
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise Unreadable("the file is damaged: a triangle names a vertex that is not there")
    used = vertices[faces.ravel()]
    if not np.isfinite(used).all():
        raise Unreadable("a vertex has a coordinate that is NaN or infinite")
    if np.abs(used).max() > LONGEST:
        raise Unreadable(f"a vertex lies farther than {LONGEST:g} m from the origin; check the unit of length")
    return Triangles(vertices, faces, _color(mesh))


def _color(mesh: Any) -> Color | None:
    if not mesh.visual.defined:
        return None
    material = getattr(mesh.visual, "material", None)
    red, green, blue, opacity = (float(x) / 255 for x in (material or mesh.visual).main_color)
    return red, green, blue, opacity or 1.0  # some exporters write 0 for opaque


def _by_color(parts: list[Triangles]) -> tuple[Triangles, ...]:
    """Parts of the same color as one."""
    return tuple(
        joined([part for part in parts if part.color == color]) for color in dict.fromkeys(p.color for p in parts)
    )
