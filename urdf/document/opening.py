"""The sources of urdf.load and urdf.inspect: a robot's name, a path, XML as text or bytes, an open file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from os import PathLike, fspath
from os.path import isfile
from pathlib import Path
from typing import IO

from graphdyn.display import short_repr
from graphdyn.model import STANDARD_GRAVITY
from urdf.document.catalog import locate
from urdf.document.dh import expand_dh
from urdf.document.document import (
    BYTES,
    MAX_URDF_BYTES,
    STREAM,
    TEXT,
    Document,
    ExpandedURDF,
    check_size,
    parsed,
    root_of,
)
from urdf.document.mjcf import expand_mjcf, is_mjcf
from urdf.document.xacro.files import expand
from urdf.errors import InvalidXacro, MalformedXML, RobotNotFound, URDFError

Given = str | bytes | PathLike[str] | IO[str] | IO[bytes]
"""A string is XML if it begins with "<", or has one and several lines and is no file; else it is a name or a path."""

UTF8 = "utf-8"

DH_SUFFIX = ".toml"

MJCF_TAG = b"mujoco"
"""What every MJCF file in an encoding that contains ASCII has in its bytes."""


@dataclass(frozen=True)
@short_repr
class Xacro:
    """How .xacro files are to be expanded.

    arguments: values of <xacro:arg> by name; packages: folder by the name that $(find NAME) gives
    """

    arguments: Mapping[str, object] = field(default_factory=dict)
    packages: Mapping[str, str | PathLike[str]] = field(default_factory=dict)


def open_document(given: Given, xacro: Xacro | None = None, use_geoms: bool = False) -> Document:
    """The document of a source; a file whose name ends with .xacro is expanded first, an MJCF file read by MuJoCo, a
    .toml file read as a table of Denavit-Hartenberg parameters.

    use_geoms: bodies of an MJCF file without <inertial> get that of their geoms

    Raises RobotNotFound, MalformedXML, TooLarge, InvalidXacro, XacroNotInstalled, InvalidMJCF, MujocoNotInstalled,
    InvalidDH, UnsupportedJoint, UnsupportedConstraint; OSError.
    """
    path, content, gravity = _read(given)
    encoding = UTF8 if isinstance(content, str) else None
    if isinstance(content, str):
        content = _encoded(content, path)
    check_size(content, path)
    if path.suffix.lower() == ".xacro":
        settings = xacro or Xacro()
        document = parsed(path, content, encoding)  # raises where the XML is malformed or unsafe
        expansion = expand(path, document.content, settings.arguments, settings.packages)
        check_size(expansion.text, path)
        expanded = parsed(path, expansion.text, UTF8, expansion.places)
        return replace(expanded, gravity=gravity, complaints=expansion.complaints)
    if xacro is not None:
        problem = "xacro arguments and packages are given, but not a file that ends with .xacro"
        remedy = "leave them out, or give the .xacro file"
        raise InvalidXacro(problem, remedy, path=path)
    if path.suffix.lower() == DH_SUFFIX:
        return _of_expansion(path, expand_dh(path, content))
    if _may_be_mjcf(content):
        root = root_of(path, content, encoding)
        if is_mjcf(root):
            return _of_expansion(path, expand_mjcf(path, content, root, use_geoms))
    return replace(parsed(path, content, encoding), gravity=gravity)


def _of_expansion(path: Path, expansion: ExpandedURDF) -> Document:
    expanded = parsed(path, expansion.text, UTF8, expansion.places)
    return replace(expanded, gravity=expansion.gravity, beyond=expansion.beyond)


def is_expanded(path: Path) -> bool:
    """Whether a file is .xacro, MJCF or a DH table, of which a URDF is made before it is read. Raises OSError."""
    if path.suffix.lower() in (".xacro", DH_SUFFIX):
        return True
    with path.open("rb") as file:
        content = file.read(MAX_URDF_BYTES + 1)
    try:
        return _may_be_mjcf(content) and is_mjcf(root_of(path, content))
    except URDFError:  # which reading it reports
        return False


def _may_be_mjcf(content: bytes) -> bool:
    """Whether it is worth looking at the root element, in UTF-16 too."""
    return MJCF_TAG in content.replace(b"\0", b"")


def content_of(path: Path, xacro: Xacro | None = None) -> bytes:
    """The bytes of a file; for a .xacro file, of its expansion, for MJCF and DH tables of the URDF that they say.

    Raises as open_document does.
    """
    return open_document(path, xacro).content if is_expanded(path) else path.read_bytes()


def path_of(given: Given) -> Path:
    """The file of a source, or TEXT, BYTES or STREAM. Raises RobotNotFound."""
    if isinstance(given, bytes):
        return BYTES
    if isinstance(given, str) and _is_xml(given):
        return TEXT
    if isinstance(given, str | PathLike):
        return locate(given)[0]
    name = getattr(given, "name", None)
    return Path(name) if isinstance(name, str) else STREAM


def said(given: Given) -> str:
    """The name or path as given; TEXT, BYTES or STREAM for other sources."""
    named = isinstance(given, str | PathLike) and not (isinstance(given, str) and _is_xml(given))
    return fspath(given) if named else str(path_of(given))  # type: ignore[arg-type]


def _read(given: Given) -> tuple[Path, str | bytes, tuple[float, float, float]]:
    path = path_of(given)
    if isinstance(given, bytes) or (isinstance(given, str) and path == TEXT):
        return path, given, STANDARD_GRAVITY
    if isinstance(given, str | PathLike):
        path, gravity = locate(given)
        with path.open("rb") as file:
            return path, file.read(MAX_URDF_BYTES + 1), gravity
    if not hasattr(given, "read"):
        raise RobotNotFound(
            f"a {type(given).__name__} is not a robot", "give a name, a path, XML as text or bytes, or an open file"
        )
    content = given.read(MAX_URDF_BYTES + 1)
    if not isinstance(content, str | bytes):
        raise RobotNotFound(f"read() of the file returns {type(content).__name__}", "open it as text or binary")
    return path, content, STANDARD_GRAVITY


def _is_xml(text: str) -> bool:
    return text.lstrip("\ufeff \t\r\n").startswith("<") or ("\n" in text and "<" in text and not isfile(text))


def _encoded(text: str, path: Path) -> bytes:
    try:
        return text.removeprefix("\ufeff").encode(UTF8)
    except UnicodeEncodeError as error:
        raise MalformedXML(
            f"character {error.start + 1} of the text is half of a surrogate pair", "give the file instead", path=path
        ) from error
