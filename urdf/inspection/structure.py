"""Which links move, and with which body: for valid trees and, as far as possible, for invalid ones."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from lxml import etree

from urdf.document.source import Source
from urdf.document.tree import carriers, joint_into, joints_by, root_links
from urdf.inspection.inertials import LinkInertial, inertials


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
