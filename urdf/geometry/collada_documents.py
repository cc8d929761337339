"""A Collada file as an XML document: foreign, so nothing in it expands, and no other file is opened."""

from __future__ import annotations

import math
import re
import warnings
from typing import Any

import numpy as np
from lxml import etree
from numpy.typing import NDArray

from graphdyn.layout import Array
from urdf._wording import shortened
from urdf.geometry.errors import Unreadable

_ENCODING = re.compile(rb"""<\?xml[^>]*encoding\s*=\s*["']([^"']*)["']""")
_ASCII_COMPATIBLE = (b"utf-8", b"utf8", b"us-ascii", b"ascii", b"iso-8859-1", b"iso-8859-15", b"windows-1252")
"""Encodings in which the bytes "<!DOCTYPE" can be found."""


class ColladaDocument:
    """The root element and the elements by their id. Raises Unreadable for what is no Collada file."""

    def __init__(self, content: bytes):
        encoding = _ENCODING.search(content[:200])
        if encoding is not None and encoding.group(1).lower() not in _ASCII_COMPATIBLE:
            raise Unreadable("the file is not in UTF-8; save it so")
        if not content.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<"):
            raise Unreadable("the file is damaged: not XML in UTF-8")
        if b"<!DOCTYPE" in content:
            raise Unreadable("the file has a document type declaration; remove <!DOCTYPE …>")
        # huge_tree: a mesh of 100,000 vertices is a text beyond libxml2's usual limit
        parser = etree.XMLParser(
            resolve_entities=False, no_network=True, load_dtd=False, huge_tree=True, remove_comments=True
        )
        try:
            self.root = etree.fromstring(content, parser)
        except etree.XMLSyntaxError as error:
            raise Unreadable(f"the file is damaged: {shortened(str(error.msg))}") from error
        name = etree.QName(self.root).localname
        if name != "COLLADA":
            raise Unreadable(f"the root element is <{shortened(name)}>, not <COLLADA>")
        self._by_id = {element.get("id"): element for element in self.root.iterfind(".//*[@id]")}

    def target(self, element: etree._Element, attribute: str = "url") -> etree._Element:
        """What an attribute such as url="#part" refers to."""
        text = element.get(attribute, "")
        found = self._by_id.get(text.removeprefix("#")) if text.startswith("#") else None
        if found is None:
            raise Unreadable(f'the file is damaged: {attribute}="{shortened(text)}" refers to nothing in it')
        return found

    def unit(self) -> float:
        """The length of its unit [m]; 1 where it says nothing."""
        element = self.root.find("./{*}asset/{*}unit")
        text = "1" if element is None else element.get("meter", "1")
        try:
            length = float(text)
        except ValueError:
            length = math.nan
        if not (math.isfinite(length) and length > 0):
            raise Unreadable(f'<unit meter="{shortened(text)}"> is not a length')
        return length


def floats(element: etree._Element | None) -> Array:
    """The numbers in its text."""
    return _numbers(element, np.float64)


def integers(element: etree._Element | None) -> NDArray[np.int64]:
    """The whole numbers in its text."""
    return _numbers(element, np.int64)


def _numbers(element: etree._Element | None, kind: Any) -> NDArray[Any]:
    if element is None or not (element.text or "").strip():
        return np.zeros(0, dtype=kind)
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # of a text that is not all numbers
        try:
            return np.fromstring(element.text or "", dtype=kind, sep=" ")
        except (DeprecationWarning, ValueError) as error:
            raise Unreadable(f"the file is damaged: <{tag(element)}> holds something that is no number") from error


def tag(element: etree._Element) -> str:
    return etree.QName(element).localname
