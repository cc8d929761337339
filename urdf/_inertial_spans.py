"""Where the <inertial> elements stand in the bytes of a URDF file, so that they alone can be replaced."""

from __future__ import annotations

import re
from dataclasses import dataclass
from xml.parsers import expat

_TAG = re.compile(rb"""<[^"'>]*(?:"[^"]*"[^"'>]*|'[^']*'[^"'>]*)*>""")
"""A whole tag; attribute values may contain '>'."""

_LINE_START = re.compile(rb"[ \t]*$")


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
            tag = _tag(data, at)
            closed = tag.endswith(b"/>")
            place = at if closed else at + len(tag)
            spans[link] = Span(place, at + len(tag), closed, _indent(data, at) + b"  ")
        elif path[1:] == ["link", "inertial"]:
            spans[link] = Span(at, at, False, _indent(data, at))

    def end(_name: str) -> None:
        at = parser.CurrentByteIndex
        if path[1:] == ["link", "inertial"]:
            spans[link] = Span(spans[link].start, at + len(_tag(data, at)), False, spans[link].indent)
        path.pop()

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.Parse(data, True)
    return spans


def _tag(data: bytes, at: int) -> bytes:
    found = _TAG.match(data, at)
    assert found is not None
    return found.group()


def _indent(data: bytes, at: int) -> bytes:
    """The blanks before a tag, if nothing else stands before it on its line."""
    line = data[data.rfind(b"\n", 0, at) + 1 : at]
    return line if _LINE_START.match(line) else b""
