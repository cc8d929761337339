"""Lines of elements: where their tags begin, and for an expansion the files and lines where they are written.

lxml knows the line where a tag ends.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from xml.parsers import expat

from lxml import etree

from urdf.document.elements import FILE

MAX_LINE = 65535
"""Largest line that lxml lets us set; beyond, an element of a file keeps the line where its tag ends."""


def number_lines(robot: etree._Element, content: bytes, encoding: str | None) -> None:
    """Give every element the line where its tag begins.

    content: of the document, whose document type has been refused; encoding: that overrides its own
    """
    lines: list[int] = []
    parser = expat.ParserCreate(encoding)
    parser.StartElementHandler = lambda _name, _attributes: lines.append(parser.CurrentLineNumber)
    with suppress(expat.ExpatError, ValueError, LookupError):  # an encoding that expat does not know: as lxml says
        parser.Parse(content, True)
    elements = list(robot.iter(etree.Element))
    if len(elements) == len(lines):
        _set(zip(elements, lines, strict=True))


def place_elements(robot: etree._Element, path: Path, places: Sequence[tuple[Path, int] | None]) -> None:
    """Give every element of an expansion the file and the line where it is written. path: of the document"""
    for node in robot.iter():
        node.sourceline = 0  # type: ignore[assignment]  # lxml's value for an unknown line
    elements = list(robot.iter(etree.Element))
    if len(elements) != len(places):
        return
    placed = [(element, place) for element, place in zip(elements, places, strict=True) if place is not None]
    _set((element, line) for element, (_, line) in placed)
    for element, (file, _) in placed:
        if file != path:
            element.set(FILE, str(file))


def _set(lines: Iterable[tuple[etree._Element, int]]) -> None:
    for element, line in lines:
        if line <= MAX_LINE:
            element.sourceline = line  # type: ignore[assignment]
