"""The <inertial> elements of a file as numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from lxml import etree

from graphdyn.layout import Array
from urdf.document.elements import name_of
from urdf.document.numbers import values
from urdf.document.source import Source

ENTRIES = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


@dataclass(frozen=True, eq=False)
class LinkInertial:
    """mass [kg], center of mass (3,) [m] in the link frame, tensor (3, 3) [kg m²] in the axes of the inertial frame.

    moments: principal moments, ascending                   (3,)  [kg m²]
    """

    link: str
    element: etree._Element
    mass: float
    center: Array
    tensor: Array
    moments: Array

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
        entries = [values(inertia, name, 1) for name in ENTRIES]
        if mass is None or mass[0] < 0 or None in entries:
            continue
        xx, xy, xz, yy, yz, zz = (entry[0] for entry in entries if entry is not None)
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        try:
            moments = np.linalg.eigvalsh(tensor)
        except np.linalg.LinAlgError:  # overflow
            moments = np.full(3, np.inf)
        if np.isfinite(moments).all():
            center = np.array(values(element.find("origin"), "xyz", 3) or (0.0, 0.0, 0.0))
            yield LinkInertial(name_of(link), element, mass[0], center, tensor, moments)
