"""Paths of the mesh files that a URDF file names. Nothing is fetched."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote

from urdf.document.document import UNNAMED_SOURCES
from urdf.document.numbers import UNEXPANDED_EXPRESSION
from urdf.errors import shortened
from urdf.geometry.shape import UnreadableMesh

PACKAGE_SCHEMES = ("package", "model")
"""Schemes that begin with the name of a package: of ROS, of Gazebo."""


def find_mesh(name: str, document: Path) -> Path:
    """The file that a URDF file calls this.

    document: the URDF file, or one of UNNAMED

    package://NAME/REST is NAME/REST in a folder above the document, else REST in one of them (a package may lie in a
    folder of another name), else NAME/REST in a folder of ROS_PACKAGE_PATH or in share/ of one of AMENT_PREFIX_PATH.

    Raises Unreadable, with the reason.
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
    for path in candidates:
        if os.path.exists(path):  # unlike Path.exists, it does not raise for impossible names
            return path
    raise UnreadableMesh("no such file")


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
    yield from (folder / within for folder in folders)
    for variable, below in (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
        for folder in filter(None, os.environ.get(variable, "").split(os.pathsep)):
            yield Path(folder, below, path)
