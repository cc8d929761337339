"""One file as an XML document: read without network, entities or other files, within limits of size.

The parser's own guards stay on: libxml2 refuses entity expansion, nesting beyond 256 levels and texts beyond 10 MB.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from graphdyn.model import STANDARD_GRAVITY
from urdf.document.connections.loops import Unread
from urdf.document.elements import line_of
from urdf.document.lines import number_lines, place_elements
from urdf.errors import MalformedXML, TooLarge

TEXT, BYTES, STREAM = Path("<text>"), Path("<bytes>"), Path("<file>")
"""Path in messages about a source that has none."""

UNNAMED_SOURCES = (TEXT, BYTES, STREAM)

MAX_URDF_BYTES = 10_000_000
"""Largest size of a file [bytes]; a robot of 2000 links with long names takes 2 MB."""

MAX_TAGS = 150_000
"""Largest number of start and end tags of a document, counted as characters "<"."""

MAX_ATTRIBUTES = 100
"""Largest number of attributes of one element; the time to read them grows with the square of their number."""

_EMPTY, _VERSION, _LIMIT = (
    etree.ErrorTypes.ERR_DOCUMENT_EMPTY,
    etree.ErrorTypes.ERR_UNKNOWN_VERSION,
    etree.ErrorTypes.ERR_RESOURCE_LIMIT,
)


@dataclass(frozen=True)
class Document:
    """A file, its bytes, and its root element <robot>.

    path: as messages give it; gravity: that goes with it (3,) [m/s²]
    complaints: warnings of the expander of .xacro files, None where the file was not expanded
    beyond: what an MJCF file or a DH table says beyond its URDF, None for other files
    """

    path: Path
    content: bytes
    robot: etree._Element
    gravity: tuple[float, float, float] = STANDARD_GRAVITY
    complaints: tuple[str, ...] | None = None
    beyond: BeyondURDF | None = None


@dataclass(frozen=True)
class BeyondURDF:
    """What a file says and URDF cannot.

    armature: by joint [kg m² or kg]
    Of MJCF: unread: what is no part of the model; between: links without mass between several joints of one body
    computed: bodies with the inertia of their geoms; None for other files
    """

    armature: Mapping[str, float]
    unread: tuple[Unread, ...] = ()
    between: frozenset[str] = frozenset()
    computed: tuple[str, ...] | None = None


@dataclass(frozen=True)
class ExpandedURDF:
    """The URDF that a file of another format says.

    text: in UTF-8; places: per element, in the order of the text, file and line where it is written; None where unknown
    gravity: of the file (3,) [m/s²]
    """

    text: bytes
    places: tuple[tuple[Path, int] | None, ...]
    gravity: tuple[float, float, float]
    beyond: BeyondURDF


def parsed(
    path: Path,
    content: bytes,
    encoding: str | None = None,
    places: Sequence[tuple[Path, int] | None] | None = None,
) -> Document:
    """The document of these bytes; path: as messages give it.

    encoding: overrides the one that the document declares
    places: of the elements, in their order, where these bytes are an expansion of other files

    Raises MalformedXML where yourdfpy would fall back on a parser that guesses, and TooLarge.
    """
    robot = root_of(path, content, encoding)
    if places is not None:
        place_elements(robot, path, places)
    name = etree.QName(robot).localname
    if robot.prefix is not None or name != "robot":
        written = name if robot.prefix is None else f"{robot.prefix}:{name}"
        problem, remedy = f"the root element is <{written}>, not <robot>", "give a URDF or MJCF file"
        raise MalformedXML(problem, remedy, code="not-a-robot", path=path, line=line_of(robot))
    return Document(path, content, robot)


def root_of(path: Path, content: bytes, encoding: str | None = None) -> etree._Element:
    """The root element of a document, with its lines. Raises as parsed does, for roots of all names alike."""
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False, encoding=encoding
    )
    try:
        robot = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise _syntax_error(path, content, error) from error
    _check_document_type(path, robot)
    if robot.xpath(f"boolean(//*[@*[{MAX_ATTRIBUTES + 1}]])"):
        raise TooLarge(f"an element has more than {MAX_ATTRIBUTES} attributes", "remove what is not URDF", path=path)
    number_lines(robot, content, encoding)
    return robot


def check_size(content: bytes, path: Path) -> None:
    """Raise TooLarge for a document that would take long to parse."""
    if len(content) > MAX_URDF_BYTES:
        problem = f"the file is larger than {MAX_URDF_BYTES // 1_000_000} MB"
        remedy = "give a URDF file; put meshes into separate files"
        raise TooLarge(problem, remedy, path=path)
    tags = content.count(b"<")
    if tags > MAX_TAGS:
        raise TooLarge(f"the file has {tags} tags, more than {MAX_TAGS}", "give a smaller file", path=path)


def _syntax_error(path: Path, content: bytes, error: etree.XMLSyntaxError) -> MalformedXML:
    message, number = " ".join(str(error.msg).split()), getattr(error, "code", None)
    if number == _LIMIT:
        problem = f"the document exceeds a limit of the XML parser: {message}"
        remedy = "give an ordinary URDF file, without entities, deep nesting and very long texts"
        return MalformedXML(problem, remedy, code="xml-limits", path=path, line=error.lineno)
    if not content.strip():
        return MalformedXML("the file is empty", "give a URDF or MJCF file", code="empty-file", path=path)
    if b"<" not in content.replace(b"\0", b""):
        return MalformedXML("the file has no XML element", "give a URDF or MJCF file", code="not-a-robot", path=path)
    code = "malformed-xml"
    if number == _EMPTY:
        code = "text-before-xml"
    elif number == _VERSION:
        code = "xml-version"
    return MalformedXML(
        f"not well-formed XML: {message}", "repair the file with an XML editor", code=code, path=path, line=error.lineno
    )


def _check_document_type(path: Path, robot: etree._Element) -> None:
    """Refuse <!DOCTYPE>: its entities change what other readers read, and a robot needs nothing else in it."""
    grammar: Any = robot.getroottree().docinfo.internalDTD
    if grammar is None:
        return
    if grammar.entities():
        raise MalformedXML(
            "the document declares XML entities", "write their text instead", code="xml-entities", path=path
        )
    raise MalformedXML(
        "the document has a document type declaration", "remove <!DOCTYPE …>", code="document-type", path=path
    )
