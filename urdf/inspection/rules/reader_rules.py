"""Files that Pinocchio's reader (urdfdom on TinyXML-2) reads a file differently from urdf.load, or refuses it.

TinyXML-2 knows no encoding but UTF-8 and leaves tabs and line breaks in attributes as they are, in names too. urdfdom
accepts blanks between numbers, and nothing after a single number; it demands parts of a joint that do not affect
dynamics.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import dropwhile

from lxml import etree

from urdf.document.document import Document
from urdf.document.elements import tag_of
from urdf.document.numbers import BadNumber, numbers
from urdf.document.vocabulary import NUMBERS, READ_CHILDREN
from urdf.errors import shortened
from urdf.inspection.findings import Finding, about, of_file

_VALUE = re.compile(rb"""=\s*("[^"<\t\n\r]*[\t\n\r][^"<]*"|'[^'<\t\n\r]*[\t\n\r][^'<]*')""")
_BLANK_BEHIND = re.compile(r"\S\s")
_KEPT = {b"\t": b"&#9;", b"\n": b"&#10;", b"\r": b"&#10;"}

_IS_UTF_8 = re.compile("UTF-?8$|(US-)?ASCII$", re.IGNORECASE)
_EXTENDS_ASCII = re.compile(rf"{_IS_UTF_8.pattern}|ISO-?8859|LATIN-?1|(WINDOWS-|CP)125", re.IGNORECASE)

_NAMES = {"link": ("name",), "joint": ("name",), "parent": ("link",), "child": ("link",)}
_NEEDED = {
    "limit": ("effort", "velocity"),
    "mimic": ("joint",),
    "safety_controller": ("k_velocity",),
}
_UNREAD = ("safety_controller", "calibration")
_UNREAD_OF_FIXED = (*_UNREAD, "limit", "dynamics", "mimic")
_VERSIONS = ("1.0", "1.1", "1.2")


def reader_findings(document: Document) -> Iterator[Finding]:
    """Findings of a document that still has all its elements."""
    yield from _encoding(document)
    yield from _instructions(document.robot)
    version = document.robot.get("version")
    if version is not None and version not in _VERSIONS:
        yield about("urdf-version", document.robot, f'version="{shortened(version)}" is none of {", ".join(_VERSIONS)}')
    verbatim = _verbatim(document)
    for element, written in zip(document.robot, verbatim, strict=True):
        if tag_of(element) in ("link", "joint"):
            yield from _names(element, written)
        if tag_of(element) == "link":
            for part, as_written in _parts(element, written):
                if tag_of(part) == "inertial":
                    yield from _spacing(part, as_written, READ_CHILDREN["inertial"])
        elif tag_of(element) == "joint":
            yield from _spacing(element, written, (*READ_CHILDREN["joint"], *_UNREAD))
            yield from _incomplete_parts(element)


def _contains_ascii(document: Document) -> bool:
    """Whether its tags are written in ASCII; UTF-16 and UTF-32 write zero bytes, whatever stands among them."""
    return b"<robot" in document.content and b"\0" not in document.content


def _encoding(document: Document) -> Iterator[Finding]:
    encoding = document.robot.getroottree().docinfo.encoding or "UTF-8"
    if not _contains_ascii(document):
        problem = f"the text is encoded in {'UTF-16' if encoding == 'UTF-8' else encoding}. Pinocchio refuses the file"
        yield of_file("other-encoding", problem, 1)
    elif not (_EXTENDS_ASCII if document.content.isascii() else _IS_UTF_8).match(encoding):
        problem = f"the text is encoded in {encoding}. Pinocchio reads it as UTF-8, with other names or numbers"
        yield of_file("other-encoding", problem, 1)


def _instructions(robot: etree._Element) -> Iterator[Finding]:
    """Processing instructions <?…?> after anything but other processing instructions."""
    nodes = [*reversed(list(robot.itersiblings(preceding=True))), robot, *robot.itersiblings()]
    found = [node for top in dropwhile(_is_instruction, nodes) for node in top.iter() if _is_instruction(node)]
    if found:
        problem = f"processing instructions <?…?> within the document: {len(found)}"
        yield of_file("processing-instruction", problem, at=found[0])


def _is_instruction(node: etree._Element) -> bool:
    tag: object = node.tag  # a string according to the stubs
    return tag is etree.ProcessingInstruction


def _verbatim(document: Document) -> etree._Element:
    """The root parsed again, with the tabs and line breaks in attributes that an XML parser turns into blanks."""
    if not _contains_ascii(document):
        return document.robot
    content = _VALUE.sub(lambda value: re.sub(rb"[\t\n\r]", lambda blank: _KEPT[blank[0]], value[0]), document.content)
    if content == document.content:
        return document.robot
    encoding = document.robot.getroottree().docinfo.encoding  # not always the one that is declared
    parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, encoding=encoding)
    return etree.fromstring(content, parser)


def _parts(element: etree._Element, written: etree._Element) -> Iterator[tuple[etree._Element, etree._Element]]:
    """Pairs of a child and the same child as written; the first of each tag, which is the one that urdfdom reads."""
    seen = set()
    for part, as_written in zip(element, written, strict=True):
        tag = tag_of(part)
        if tag not in seen:
            seen.add(tag)
            yield part, as_written


def _names(element: etree._Element, written: etree._Element) -> Iterator[Finding]:
    """Names in a link or joint that an XML parser reads with blanks in the place of tabs and line breaks."""
    for part, as_written in ((element, written), *_parts(element, written)):
        for name in _NAMES.get(tag_of(part), ()):
            if part.get(name) != as_written.get(name):
                problem = f"tabs or line breaks in {name}: an XML parser reads blanks. Pinocchio reads another name"
                yield about("name-spacing", part, problem)


def _spacing(element: etree._Element, written: etree._Element, read: Sequence[str]) -> Iterator[Finding]:
    """Numbers that are valid and that urdfdom does not read, in the children with the tags that are read."""
    for part, as_written in _parts(element, written):
        if element.get("type") == "fixed" and tag_of(part) == "axis":
            continue
        for name, count in NUMBERS.get(tag_of(part), {}).items() if tag_of(part) in read else ():
            text = as_written.get(name)
            if text is None or _is_read(text, count) or isinstance(numbers(text, count, ""), BadNumber):
                continue
            if tag_of(element) == "joint":
                consequence = "Pinocchio refuses the file"
            elif tag_of(part) == "inertia":
                consequence = "Pinocchio gives the link a tensor of zero"
            else:
                consequence = "Pinocchio gives the link mass 0"
            problem = f"blanks, tabs or line breaks in {name} that not every reader accepts. {consequence}"
            yield about("number-spacing", part, problem)


def _is_read(text: str, count: int) -> bool:
    """Whether urdfdom reads it: it splits triples at blanks and allows white space before a number, not after it."""
    words = text.split(" ") if count > 1 else (text,)
    return not any(map(_BLANK_BEHIND.search, words))


def _incomplete_parts(joint: etree._Element) -> Iterator[Finding]:
    """Parts that urdf.load does not read, or reads although something is missing."""
    unread = _UNREAD_OF_FIXED if joint.get("type") == "fixed" else _UNREAD
    for part, _ in _parts(joint, joint):
        tag = tag_of(part)
        lacking = [name for name in _NEEDED.get(tag, ()) if part.get(name) is None]
        if tag == "dynamics" and part.get("damping") is None and part.get("friction") is None:
            lacking = ["damping or friction"]
        if lacking and (tag in unread or tag != "limit"):  # the other limits have a finding of their own
            needed = tag == "mimic" and tag not in unread
            problem = f"without {', '.join(lacking)}" + ("" if needed else "; dynamics do not need it")
            yield about("incomplete-joint-part", part, problem)
        for name in NUMBERS[tag] if tag in unread else ():
            text = part.get(name)
            found = None if text is None else numbers(text, 1, f'{name}="{shortened(text)}"')
            if isinstance(found, BadNumber):
                yield about("incomplete-joint-part", part, f"{found.problem}; dynamics do not need it")
