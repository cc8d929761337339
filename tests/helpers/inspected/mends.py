"""Explanations put to the test: a file is mended in exactly the place that a finding names, and nowhere else.

Where a finding explains why Pinocchio refuses a file or has other numbers, Pinocchio must agree on the mended one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from lxml import etree

import urdf
from urdf.document.elements import describe, tag_of
from urdf.document.lines import number_lines

NEW_NAME = "renamed"
UNLIMITED = {"effort": "1e6", "velocity": "1e6"}
UNBOUNDED = {"lower": "-1e6", "upper": "1e6"}


def mended(content: bytes, findings: Iterable[urdf.Finding]) -> bytes | None:
    """The file with every place mended that one of these findings names; None where none of them can be."""
    tree = etree.fromstring(content).getroottree()
    number_lines(tree.getroot(), content, None)
    places = [
        (finding, element)
        for finding in findings
        if finding.code in MENDS
        for element in tree.getroot().iter(etree.Element)
        if finding.element is None or (finding.line, finding.element) == (element.sourceline, describe(element))
    ]
    for finding, element in places:
        MENDS[finding.code](element)
    return etree.tostring(tree.getroot(), encoding="UTF-8") if places else None


def _space_evenly(element: etree._Element) -> None:
    for name, text in element.attrib.items():
        element.set(name, " ".join(text.split()))


def _remove(element: etree._Element) -> None:
    """With its repetitions: urdfdom reads the first that is left. A second finding may name a place that is gone."""
    parent = element.getparent()
    for same in () if parent is None else parent.findall(element.tag):
        parent.remove(same)


def _limit(element: etree._Element) -> None:
    """A joint without <limit>, or a <limit> without numbers, or with a negative effort or velocity."""
    alone = tag_of(element) == "joint"
    joint, limit = (element, etree.SubElement(element, "limit")) if alone else (element.getparent(), element)
    for name, value in UNLIMITED.items():
        if not limit.get(name) or float(limit.get(name, "0")) < 0:
            limit.set(name, value)
    for name, value in UNBOUNDED.items() if joint.get("type") != "continuous" else ():
        limit.set(name, limit.get(name, value))


def _no_friction(element: etree._Element) -> None:
    element.set("friction", "0")


def _remove_instructions(element: etree._Element) -> None:
    """Those around the root go with the tree."""
    for child in element:
        if child.tag is etree.ProcessingInstruction:
            element.remove(child)


def _rename_material(element: etree._Element) -> None:
    if etree.QName(element).localname == "material":
        element.set("name", f"{element.get('name')} {id(element)}")


def _rename(element: etree._Element) -> None:
    element.set("name", NEW_NAME)


def _drop_version(element: etree._Element) -> None:
    del element.attrib["version"]


MENDS: dict[str, Callable[[etree._Element], None]] = {
    "number-spacing": _space_evenly,
    "incomplete-joint-part": _remove,
    "limits-missing": _limit,
    "effort-negative": _limit,
    "velocity-negative": _limit,
    "friction-negative": _no_friction,
    "processing-instruction": _remove_instructions,
    "duplicate-material": _rename_material,
    "urdf-version": _drop_version,
    "reserved-name": _rename,
    "name-spacing": lambda element: None,  # writing it anew is all
    "other-encoding": lambda element: None,  # writing it anew is all
}
