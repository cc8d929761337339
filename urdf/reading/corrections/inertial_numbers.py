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
    """mass [kg], center of mass (3,) [m], rotation (3, 3) of the axes of the tensor (3, 3) [kg m²]."""

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
    def is_placeholder(self) -> bool:
        """Whether all moments are the same, as of a guess, which tells nothing of the size of a link."""
        return bool((self.tensor == self.tensor[0, 0] * np.eye(3)).all())

    def is_possible(self, least: float) -> bool:
        """Whether principal moments are at least this part of the largest, and none exceeds the sum of the others by
        more than few digits explain."""
        low, middle, high = self.moments
        return bool(low >= least * abs(high) and high - low - middle <= FEW_DIGITS * abs(high))


def inertial_numbers(inertial: etree._Element) -> InertialNumbers | None:
    """None where a number is missing or malformed, infinite when squared, or the mass is not positive."""
    origin, inertia = inertial.find("origin"), inertial.find("inertia")
    mass = values(inertial.find("mass"), "value", 1)
    entries = [values(inertia, name, 1) for name in NUMBERS["inertia"]]
    if mass is None or mass[0] <= 0 or None in entries:
        return None
    xx, xy, xz, yy, yz, zz = (entry[0] for entry in entries if entry is not None)
    center, angles = (values(origin, name, 3) or [0.0, 0.0, 0.0] for name in ("xyz", "rpy"))
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    found = InertialNumbers(mass[0], np.array(center), rotation_from_rpy(*angles), tensor)
    with np.errstate(all="ignore"):
        finite = np.isfinite(tensor @ tensor).all() and np.isfinite(found.center @ found.center)
    return found if finite and tensor.any() else None
