"""Collada files, looked at before they are read: the unit of length, and what would fill the memory."""

from __future__ import annotations

import math
import re

from lxml import etree

from urdf._wording import shortened
from urdf.geometry.errors import Unreadable

_ENCODING = re.compile(rb"""<\?xml[^>]*encoding\s*=\s*["']([^"']*)["']""")
_ASCII_COMPATIBLE = (b"utf-8", b"utf8", b"us-ascii", b"ascii", b"iso-8859-1", b"iso-8859-15", b"windows-1252")

DEEPEST = 100
"""Largest depth of nodes in each other, those that are named instead of written counted too."""

LEAST = 1000
"""Bytes that a node counts for, even an empty one."""


def check_collada(content: bytes, largest: int) -> float:
    """The length of its unit [m].

    largest: how many bytes of triangles the file may stand for, geometry that occurs several times counted as often

    Raises Unreadable for a file that is no Collada, one with a document type (entities expand without limit), one
    whose nodes repeat each other so that the geometry grows beyond the limit, and a unit that is no length.
    """
    encoding = _ENCODING.search(content[:200])
    if encoding is not None and encoding.group(1).lower() not in _ASCII_COMPATIBLE:
        raise Unreadable("the file is not in UTF-8; save it so")
    if not content.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<"):
        raise Unreadable("the file is damaged: not XML in UTF-8")
    if b"<!DOCTYPE" in content:
        raise Unreadable("the file has a document type declaration; remove <!DOCTYPE …>")
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True, remove_comments=True, remove_pis=True
    )
    try:
        root = etree.fromstring(content, parser)
    except etree.XMLSyntaxError as error:
        raise Unreadable(f"the file is damaged: {error.msg}") from error
    if etree.QName(root).localname != "COLLADA":
        raise Unreadable(f"the root element is <{shortened(etree.QName(root).localname)}>, not <COLLADA>")
    if _expanded(root) > largest:
        raise Unreadable(f"its nodes repeat geometry until it has more than {largest // 1_000_000} MB")
    return _unit(root)


def _unit(root: etree._Element) -> float:
    element = root.find("./{*}asset/{*}unit")
    text = "1" if element is None else element.get("meter", "1")
    try:
        length = float(text)
    except ValueError:
        length = math.nan
    if not (math.isfinite(length) and length > 0):
        raise Unreadable(f'<unit meter="{shortened(text)}"> is not a length')
    return length


def _expanded(root: etree._Element) -> int:
    """Bytes of text of all geometry that the scenes show, counted as often as it is shown."""
    geometries = {each.get("id"): sum(map(len, each.itertext())) for each in root.iter("{*}geometry")}
    nodes = {each.get("id"): each for each in root.iter("{*}node")}
    known: dict[etree._Element, int] = {}

    def size(element: etree._Element, depth: int) -> int:
        if depth > DEEPEST:
            raise Unreadable(f"its nodes are nested more than {DEEPEST} deep")
        if element not in known:
            total = 0
            for child in element.iterchildren("{*}node", "{*}instance_node", "{*}instance_geometry"):
                tag, target = etree.QName(child).localname, child.get("url", "").removeprefix("#")
                if tag == "instance_geometry":
                    total += LEAST + geometries.get(target, 0)
                else:
                    node = child if tag == "node" else nodes.get(target)
                    total += LEAST + (0 if node is None else size(node, depth + 1))
            known[element] = total
        return known[element]

    return sum(size(scene, 0) for scene in root.iter("{*}visual_scene"))
