"""Findings about what surrounds the robot: the text of the file, xacro leftovers, meshes, materials.

Findings about what urdf.load does not read.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator

from lxml import etree

from urdf.document.document import Document
from urdf.document.elements import line_of, name_of
from urdf.document.numbers import UNEXPANDED_EXPRESSION
from urdf.errors import listed, shortened
from urdf.inspection.findings import Finding
from urdf.inspection.messages import of_file, told
from urdf.inspection.structure import Structure

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_PREFIX = re.compile(rb"\bxmlns:([\w.-]+)\s*=")


def document_findings(document: Document) -> Iterator[Finding]:
    """Findings of a document that still has all its elements."""
    yield from _text(document.content)
    namespace = etree.QName(document.robot).namespace
    if namespace:
        yield of_file(
            "default-namespace",
            "note",
            line_of(document.robot),
            f"the root element has the default namespace {shortened(namespace)}",
            "remove xmlns=… from <robot>",
        )
    yield from _elements(document.robot)


def _text(content: bytes) -> Iterator[Finding]:
    if content.startswith(BYTE_ORDER_MARK):
        yield of_file("byte-order-mark", "note", 1, "the file begins with a byte-order mark", "no action needed")
        content = content[len(BYTE_ORDER_MARK) :]
    ends = content.count(b"\r\n")
    if ends:
        yield of_file("crlf", "note", 1, f"lines that end with CR LF: {ends}", "no action needed")
    if not content.isascii():
        line = next(number for number, text in enumerate(content.split(b"\n"), start=1) if not text.isascii())
        yield of_file("non-ascii", "note", line, "the text is not all ASCII", "make sure that other tools read it")
    prefixes = dict.fromkeys(_PREFIX.findall(content))
    if prefixes:
        names = listed(prefix.decode(errors="replace") for prefix in prefixes)
        yield of_file(
            "extra-namespaces", "note", None, f"declared namespaces that URDF does not need: {names}", "remove them"
        )


def _elements(robot: etree._Element) -> Iterator[Finding]:
    """One pass over all elements, including those that do not affect dynamics."""
    xacro: Counter[str] = Counter()
    lines: dict[str, int | None] = {}
    meshes, packages, unexpanded = 0, 0, 0
    materials: dict[str, list[int | None]] = {}
    for element in robot.iter(etree.Element):
        name = etree.QName(element)
        if name.namespace is not None and name.namespace.rstrip("/").endswith("xacro"):
            xacro[name.localname] += 1
            lines.setdefault("xacro", line_of(element))
        elif name.localname == "mesh":
            meshes += 1
            packages += element.get("filename", "").startswith("package://")
            lines.setdefault("mesh", line_of(element))
        elif name.localname == "material" and element.getparent() is robot:
            materials.setdefault(name_of(element), []).append(line_of(element))
        texts = [text for text in element.attrib.values() if UNEXPANDED_EXPRESSION.search(str(text))]
        if texts:
            unexpanded += len(texts)
            lines.setdefault("unexpanded", line_of(element))
    if xacro:
        tags = listed(f"xacro:{tag}" for tag in xacro)
        harmless = set(xacro) <= {"property", "arg"}
        yield of_file(
            "xacro-tags",
            "note" if harmless else "warning",
            lines["xacro"],
            f"xacro elements that are left in and ignored: {xacro.total()} ({tags})",
            "remove them" if harmless else "expand the file with xacro: what they stand for is missing",
        )
    if meshes:
        yield of_file(
            "mesh-files",
            "note",
            lines["mesh"],
            f"mesh files, not opened because dynamics need none: {meshes}, of which {packages} at package:// paths",
            "no action needed",
        )
    if unexpanded:
        yield of_file(
            "unexpanded-text",
            "warning",
            lines["unexpanded"],
            f"attributes with ${{…}} or $(…) that are not expanded: {unexpanded}",
            "expand the file with xacro",
        )
    for material, places in materials.items():
        if len(places) > 1:
            yield of_file(
                "duplicate-material",
                "warning",
                places[1],
                f"material '{shortened(material)}' is defined {len(places)} times, first in line {places[0]}",
                "keep one of them",
            )


DOCUMENT_REMEDIES = {
    "unread-dynamics": "change the model after loading it, if that matters",
    "unknown-element": "correct its name, or remove it",
    "unknown-attribute": "correct its name, or remove it",
}


def unread_findings(structure: Structure) -> Iterator[Finding]:
    """Findings about elements and attributes that change the dynamics elsewhere, or that URDF does not know."""
    for unread in structure.source.extensions.unread:
        number = f" ({unread.places} such places)" if unread.places > 1 else ""
        message = told(unread.code, f"{unread.problem}: not read{number}")
        yield Finding(unread.code, "warning", unread.element, unread.line, message, DOCUMENT_REMEDIES[unread.code])
