"""The numbers of an <inertial>, whether a body can have them or not."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from lxml import etree

from graphdyn.layout import Array
from urdf.document.numbers import rotation_from_rpy, values
from urdf.document.vocabulary import NUMBERS

FEW_DIGITS = 0.02
"""Part of the largest moment by which a tensor may miss what bodies can have, because it is written with few digits."""


@dataclass(frozen=True, eq=False)
class InertialNumbers:
    """mass [kg], center of mass (3,) [m] in the link frame, tensor (3, 3) [kg m²] in the axes of the inertial frame.

    rotation: from these axes to those of the link          (3, 3)
    """

    mass: float
    center: Array
    rotation: Array
    tensor: Array

    @cached_property
    def turned(self) -> Array:
        """The tensor in link axes (3, 3) [kg m²]."""
        turned: Array = self.rotation @ self.tensor @ self.rotation.T
        return turned

    @cached_property
    def moments(self) -> Array:
        """Principal moments, ascending (3,) [kg m²]."""
        return np.linalg.eigvalsh(self.tensor).astype(float)

    @property
    def size(self) -> float:
        """Sum of the sizes of the principal moments, zero for a tensor of zero [kg m²]."""
        return float(np.abs(self.moments).sum())

    @property
    def is_placeholder(self) -> bool:
        """Whether all moments are the same, as of a guess, which tells nothing of the size of a link."""
        return bool((self.tensor == self.tensor[0, 0] * np.eye(3)).all())

    def is_possible(self, least: float) -> bool:
        """Whether principal moments are at least this part of the largest, and none exceeds the sum of the others by
        more than few digits explain."""
        low, middle, high = self.moments
        return bool(low >= least * abs(high) and high - low - middle <= FEW_DIGITS * abs(high))


def inertial_numbers(inertial: etree._Element) -> InertialNumbers | None:
    """None where a number is missing, malformed or so large that moments are infinite, or the mass is negative."""
    origin, inertia = inertial.find("origin"), inertial.find("inertia")
    mass = values(inertial.find("mass"), "value", 1)
    entries = [values(inertia, name, 1) for name in NUMBERS["inertia"]]
    if mass is None or mass[0] < 0 or None in entries:
        return None
    xx, xy, xz, yy, yz, zz = (entry[0] for entry in entries if entry is not None)
    center, angles = (values(origin, name, 3) or [0.0, 0.0, 0.0] for name in ("xyz", "rpy"))
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    found = InertialNumbers(mass[0], np.array(center), rotation_from_rpy(*angles), tensor)
    try:
        return found if np.isfinite(found.moments).all() else None
    except np.linalg.LinAlgError:  # overflow
        return None
