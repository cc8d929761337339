"""Findings about what surrounds the robot: text, names, xacro leftovers, meshes, what urdf.load does not read."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator

from lxml import etree

from urdf.document.document import Document
from urdf.document.elements import line_said, name_of
from urdf.document.numbers import UNEXPANDED_EXPRESSION
from urdf.document.tree import end
from urdf.errors import listed, shortened
from urdf.inspection.findings import Finding, about, found, of_file
from urdf.inspection.structure import Structure

BYTE_ORDER_MARK = b"\xef\xbb\xbf"
_PREFIX = re.compile(rb"\bxmlns:([\w.-]+)\s*=")


def document_findings(document: Document) -> Iterator[Finding]:
    """Findings of a document that still has all its elements."""
    if document.complaints is None:  # an expansion is another text than the file
        yield from _text(document.content)
    namespace = etree.QName(document.robot).namespace
    if namespace:
        problem = f"the root element has the default namespace {shortened(namespace)}"
        yield of_file("default-namespace", problem, at=document.robot)
    yield from _elements(document.robot)


def _text(content: bytes) -> Iterator[Finding]:
    if content.startswith(BYTE_ORDER_MARK):
        yield of_file("byte-order-mark", "the file begins with a byte-order mark", 1)
        content = content[len(BYTE_ORDER_MARK) :]
    ends = content.count(b"\r\n")
    if ends:
        yield of_file("crlf", f"lines that end with CR LF: {ends}", 1)
    if not content.isascii():
        line = next(number for number, text in enumerate(content.split(b"\n"), start=1) if not text.isascii())
        yield of_file("non-ascii", "the text is not all ASCII", line)
    prefixes = dict.fromkeys(_PREFIX.findall(content))
    if prefixes:
        names = listed(prefix.decode(errors="replace") for prefix in prefixes)
        yield of_file("extra-namespaces", f"declared namespaces that URDF does not need: {names}")


def _elements(robot: etree._Element) -> Iterator[Finding]:
    """One pass over all elements, including those that do not affect dynamics."""
    xacro: Counter[str] = Counter()
    first: dict[str, etree._Element] = {}
    meshes, packages, unexpanded = 0, 0, 0
    materials: dict[str, list[etree._Element]] = {}
    for element in robot.iter(etree.Element):
        name = etree.QName(element)
        if name.namespace is not None and name.namespace.rstrip("/").endswith("xacro"):
            xacro[name.localname] += 1
            first.setdefault("xacro", element)
        elif name.localname == "mesh":
            meshes += 1
            packages += element.get("filename", "").startswith("package://")
            first.setdefault("mesh", element)
        elif name.localname == "material" and element.getparent() is robot:
            materials.setdefault(name_of(element), []).append(element)
        texts = [text for text in element.attrib.values() if UNEXPANDED_EXPRESSION.search(str(text))]
        if texts:
            unexpanded += len(texts)
            first.setdefault("unexpanded", element)
    if xacro:
        tags = listed(f"xacro:{tag}" for tag in xacro)
        harmless = set(xacro) <= {"property", "arg"}
        problem = f"xacro elements that are left in and ignored: {xacro.total()} ({tags})"
        yield of_file("xacro-tags", problem, at=first["xacro"], severity="note" if harmless else "warning")
    if meshes:
        yield of_file(
            "mesh-files",
            f"mesh files, not opened because dynamics need none: {meshes}, of which {packages} at package:// paths",
            at=first["mesh"],
        )
    if unexpanded:
        problem = f"attributes with ${{…}} or $(…) that are not expanded: {unexpanded}"
        yield of_file("unexpanded-text", problem, at=first["unexpanded"])
    for material, places in materials.items():
        if len(places) > 1:
            problem = (
                f"material '{shortened(material)}' is defined {len(places)} times, first in {line_said(places[0])}"
            )
            yield of_file("duplicate-material", problem, at=places[1])


def unread_findings(structure: Structure) -> Iterator[Finding]:
    """Findings about elements and attributes that change the dynamics elsewhere, or that URDF does not know."""
    for unread in structure.source.extensions.unread:
        number = f" ({unread.places} such places)" if unread.places > 1 else ""
        problem = f"{unread.problem}: not read{number}"
        yield found(unread.code, problem, unread.element, unread.line, unread.file)


RESERVED_NAME = "universe"


def name_findings(structure: Structure) -> Iterator[Finding]:
    """Findings about names, and about joints before their parents."""
    source = structure.source
    links = {name_of(link): line_said(link) for link in source.links}
    for joint in source.joints:
        name = name_of(joint)
        if name and name in links:
            problem = f"the link in {links[name]} has this name too: the frame of this name is the link's"
            yield about("shared-name", joint, problem)
        if name == RESERVED_NAME:
            yield about("reserved-name", joint, "the ground has this name in Pinocchio")
    for element in (*source.links, *source.joints):
        if "/" in name_of(element):
            yield about("slash-in-name", element, "a slash in the name")
    yield from _order(structure)


def _order(structure: Structure) -> Iterator[Finding]:
    """The first joint that comes before the joint of its parent link."""
    places = {id(joint): number for number, joint in enumerate(structure.source.joints)}
    for number, joint in enumerate(structure.source.joints):
        above = structure.joint_into.get(end(joint, "parent") or "")
        if above is not None and places[id(above)] > number:
            before = shortened(name_of(above))
            problem = f"it comes before joint '{before}', which carries its parent link; load numbers parents first"
            yield about("joint-order", joint, problem)
            return
