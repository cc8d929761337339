"""The <inertial> elements as numbers, and which links move with which body, for invalid trees too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

from lxml import etree

from urdf.document.elements import name_of
from urdf.document.inertial_numbers import InertialNumbers, inertial_numbers
from urdf.document.source import Source
from urdf.document.tree import carriers, joint_into, joints_by, root_links


@dataclass(frozen=True, eq=False)
class LinkInertial(InertialNumbers):
    """The numbers of an <inertial>, with the link that has it."""

    link: str
    element: etree._Element


def inertials(source: Source) -> Iterator[LinkInertial]:
    """The <inertial> elements that are complete and have valid numbers."""
    for link in source.links:
        element = link.find("inertial")
        found = None if element is None else inertial_numbers(element)
        if element is not None and found is not None:
            yield LinkInertial(found.mass, found.center, found.rotation, found.tensor, name_of(link), element)


@dataclass(frozen=True)
class Structure:
    """How the links and joints of a file are connected.

    rooted: there is one root link, and with it a ground
    carrier: per link, the first link of the body it belongs to; None where it never moves
    joint_into: per link, the joint that carries it; joints_from: per link, the joints that it carries
    inertials: of the links that have a valid <inertial>, in file order
    """

    source: Source
    rooted: bool
    carrier: dict[str, str | None]
    joint_into: dict[str, etree._Element]
    joints_from: dict[str, list[etree._Element]]
    inertials: tuple[LinkInertial, ...]

    @classmethod
    def of(cls, source: Source) -> Structure:
        joints_from = joints_by(source, "parent")
        rooted = len(root_links(source)) == 1
        return cls(source, rooted, carriers(source), joint_into(source), joints_from, tuple(inertials(source)))

    def moving(self, link: str) -> bool:
        return self.carrier.get(link) is not None

    def still(self, link: str) -> bool:
        """Whether the link belongs to the ground."""
        return self.rooted and self.carrier.get(link, link) is None

    @cached_property
    def members(self) -> dict[str, list[str]]:
        """Per moving body, by its first link: its links, in the order of the tree."""
        found: dict[str, list[str]] = {}
        for link, carrier in self.carrier.items():
            if carrier is not None:
                found.setdefault(carrier, []).append(link)
        return found

    @property
    def movable(self) -> list[etree._Element]:
        """The joints that are not fixed, in file order."""
        return [joint for joint in self.source.joints if joint.get("type") != "fixed"]
