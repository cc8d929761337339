"""Findings about names and the order of the file."""

from __future__ import annotations

from collections.abc import Iterator

from urdf.document.elements import line_of, name_of
from urdf.document.tree import end
from urdf.errors import shortened
from urdf.inspection.findings import Finding
from urdf.inspection.messages import about
from urdf.inspection.structure import Structure

RESERVED_NAME = "universe"


def name_findings(structure: Structure) -> Iterator[Finding]:
    """Findings about names, and about joints before their parents."""
    source = structure.source
    links = {name_of(link): line_of(link) for link in source.links}
    for joint in source.joints:
        name = name_of(joint)
        if name and name in links:
            yield about(
                "shared-name",
                "note",
                joint,
                f"the link in line {links[name]} has this name too: the frame of this name is the link's",
                "give one of them another name",
            )
        if name == RESERVED_NAME:
            yield about("reserved-name", "warning", joint, "the ground has this name in Pinocchio", "rename it")
    for element in (*source.links, *source.joints):
        if "/" in name_of(element):
            yield about(
                "slash-in-name",
                "note",
                element,
                "a slash in the name",
                "some tools take it for a namespace or a folder",
            )
    yield from _order(structure)


def _order(structure: Structure) -> Iterator[Finding]:
    """The first joint that comes before the joint of its parent link."""
    places = {id(joint): number for number, joint in enumerate(structure.source.joints)}
    for number, joint in enumerate(structure.source.joints):
        above = structure.joint_into.get(end(joint, "parent") or "")
        if above is not None and places[id(above)] > number:
            before = shortened(name_of(above))
            yield about(
                "joint-order",
                "note",
                joint,
                f"it comes before joint '{before}', which carries its parent link; load numbers parents first",
                "identify joints by their names, not by the order of the file",
            )
            return
