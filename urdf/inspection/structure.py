"""The <inertial> elements as numbers, and which links move with which body, for invalid trees too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from lxml import etree

from graphdyn.layout import Array
from urdf.document.elements import name_of
from urdf.document.numbers import rotation_from_rpy, values
from urdf.document.source import Source
from urdf.document.tree import carriers, joint_into, joints_by, root_links
from urdf.document.vocabulary import NUMBERS


@dataclass(frozen=True, eq=False)
class LinkInertial:
    """mass [kg], center of mass (3,) [m] in the link frame, tensor (3, 3) [kg m²] in the axes of the inertial frame.

    rotation: from these axes to those of the link          (3, 3)
    moments: principal moments, ascending                   (3,)  [kg m²]
    """

    link: str
    element: etree._Element
    mass: float
    center: Array
    tensor: Array
    rotation: Array
    moments: Array

    @property
    def link_tensor(self) -> Array:
        """The tensor in link axes (3, 3) [kg m²]."""
        return np.asarray(self.rotation @ self.tensor @ self.rotation.T)

    @property
    def size(self) -> float:
        """Sum of the sizes of the principal moments, zero for a tensor of zero [kg m²]."""
        return float(np.abs(self.moments).sum())


def inertials(source: Source) -> Iterator[LinkInertial]:
    """The <inertial> elements that are complete and have valid numbers."""
    for link in source.links:
        element = link.find("inertial")
        if element is None:
            continue
        inertia = element.find("inertia")
        mass = values(element.find("mass"), "value", 1)
        entries = [values(inertia, name, 1) for name in NUMBERS["inertia"]]
        if mass is None or mass[0] < 0 or None in entries:
            continue
        xx, xy, xz, yy, yz, zz = (entry[0] for entry in entries if entry is not None)
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        try:
            moments = np.linalg.eigvalsh(tensor)
        except np.linalg.LinAlgError:  # overflow
            moments = np.full(3, np.inf)
        if np.isfinite(moments).all():
            origin = element.find("origin")
            center = np.array(values(origin, "xyz", 3) or (0.0, 0.0, 0.0))
            rotation = rotation_from_rpy(*(values(origin, "rpy", 3) or (0.0, 0.0, 0.0)))
            yield LinkInertial(name_of(link), element, mass[0], center, tensor, rotation, moments)


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
