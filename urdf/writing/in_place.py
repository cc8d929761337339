"""Edits in the bytes of a URDF file: single attributes and <inertial> elements; every other byte stays as it was."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.parsers import expat

from lxml import etree

from urdf.document.opening import DH_SUFFIX, is_expanded
from urdf.errors import CannotUpdate

_TAG = re.compile(rb"""<[^"'>]*(?:"[^"]*"[^"'>]*|'[^']*'[^"'>]*)*>""")
"""A whole tag; attribute values may contain '>'."""

_LINE_START = re.compile(rb"[ \t]*$")


def refuse_expanded(path: Path) -> None:
    """Raises CannotUpdate."""
    if path.suffix.lower() == ".xacro":
        raise CannotUpdate(
            "a .xacro file has no <inertial> of its own to edit", "expand it and give the URDF", path=path
        )
    if path.suffix.lower() == DH_SUFFIX:
        remedy = "urdf.save_dh (graphdyn export --to dh) writes a new table"
        raise CannotUpdate("the file is a table of Denavit-Hartenberg parameters, not URDF", remedy, path=path)
    if is_expanded(path):
        remedy = "urdf.patch_mjcf (graphdyn export --to mjcf --patch) writes new inertials into it"
        raise CannotUpdate("the file is MJCF, not URDF", remedy, path=path)


def editable(path: Path) -> bytes:
    """The bytes of a document that can be read. Raises the error of check_editable; OSError."""
    data = path.read_bytes()
    check_editable(path, data)
    return data


def check_editable(path: Path, data: bytes) -> None:
    """Raises CannotUpdate for UTF-16 and the like. data: of a document that can be read"""
    try:
        if b"\0" in data:
            raise LookupError
        expat.ParserCreate().Parse(data, True)
    except (LookupError, ValueError, expat.ExpatError):  # of other encodings than of one byte, or UTF-8
        problem = "the file is in UTF-16 or another encoding that cannot be edited"
        raise CannotUpdate(problem, "save it as UTF-8 first", path=path) from None


@dataclass(frozen=True)
class Span:
    """Bytes start … end of one link: its <inertial>, or the place for one.

    closed: the link is a single tag, <link …/>, which has to be opened
    indent: what stands before the element on its line
    """

    start: int
    end: int
    closed: bool
    indent: bytes


def inertial_spans(data: bytes) -> dict[str, Span]:
    """The span of every link by its name. data: a document that loads, in an encoding that contains ASCII."""
    spans: dict[str, Span] = {}
    path: list[str] = []
    link = ""
    parser = expat.ParserCreate()

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal link
        path.append(name)
        at = parser.CurrentByteIndex
        if path[1:] == ["link"]:
            link = attributes.get("name", "")
            tag = tag_at(data, at)
            closed = tag.endswith(b"/>")
            place = at if closed else at + len(tag)
            spans[link] = Span(place, at + len(tag), closed, indent_before(data, at) + b"  ")
        elif path[1:] == ["link", "inertial"]:
            spans[link] = Span(at, at, False, indent_before(data, at))

    def end(_name: str) -> None:
        at = parser.CurrentByteIndex
        if path[1:] == ["link", "inertial"]:
            spans[link] = Span(spans[link].start, at + len(tag_at(data, at)), False, spans[link].indent)
        path.pop()

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.Parse(data, True)
    return spans


def tag_at(data: bytes, at: int) -> bytes:
    """The whole tag that begins there."""
    found = _TAG.match(data, at)
    assert found is not None
    return found.group()


def indent_before(data: bytes, at: int) -> bytes:
    """The blanks before a tag, if nothing else stands before it on its line."""
    line = data[data.rfind(b"\n", 0, at) + 1 : at]
    return line if _LINE_START.match(line) else b""


def with_inertials(data: bytes, edits: list[tuple[Span, etree._Element]]) -> bytes:
    """The document with these <inertial> elements, inserted from the end so that earlier positions stay valid."""
    newline = b"\r\n" if b"\r\n" in data else b"\n"
    for span, element in sorted(edits, key=lambda edit: edit[0].start, reverse=True):
        etree.indent(element, space="  ")
        lines = etree.tostring(element).split(b"\n")
        text = (newline + span.indent).join(lines)
        if span.closed:
            tag = data[span.start : span.end]
            outer = newline + span.indent[:-2]
            text = tag[: tag.rindex(b"/")].rstrip() + b">" + newline + span.indent + text + outer + b"</link>"
        elif span.start == span.end:
            text = newline + span.indent + text
        data = data[: span.start] + text + data[span.end :]
    return data


def attributes_in(tag: bytes) -> Iterator[tuple[str, int, int]]:
    """Name of each attribute of a tag, and begin and end of its value there."""
    for found in _ATTRIBUTE.finditer(tag):
        yield found[1].decode(), found.start(2) + 1, found.end(2) - 1


_ATTRIBUTE = re.compile(rb"""([^\s=<>/"']+)\s*=\s*("[^"]*"|'[^']*')""")


def with_attributes(data: bytes, changes: Mapping[int, Mapping[str, str]]) -> bytes:
    """The document with other values of attributes that it has.

    changes: new values by name, by the number of the element in the order of the start tags, from 0
    """
    edits: list[tuple[int, int, bytes]] = []
    number = -1
    parser = expat.ParserCreate()

    def start(_name: str, _attributes: dict[str, str]) -> None:
        nonlocal number
        number += 1
        at = parser.CurrentByteIndex
        for name, begin, end in attributes_in(tag_at(data, at)) if number in changes else ():
            value = changes[number].get(name)
            if value is not None:
                edits.append((at + begin, at + end, value.encode()))

    parser.StartElementHandler = start
    parser.Parse(data, True)
    for begin, end, value in reversed(edits):
        data = data[:begin] + value + data[end:]
    return data
