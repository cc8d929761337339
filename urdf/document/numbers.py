"""Numbers as a URDF file writes them: decimal, finite, separated by spaces.

Roll, pitch and yaw of a rotation, R = R_z(yaw) R_y(pitch) R_x(roll), accurate in every pose.

Placements, inertials and numbers as the attributes that urdf.save writes.
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from lxml import etree

from graphdyn import Body, Placement
from graphdyn.layout import Array
from graphdyn.model import rotation_about
from urdf.errors import shortened

NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
"""Pattern of a number in every text that is read: Python's float takes more, such as 1_0 and the digits of Arabic."""

_NUMBER = re.compile(NUMBER)

_BLANKS = re.compile(r"[ \t\r\n]+")
"""White space of XML; str.split splits at many more characters, which no other reader of URDF accepts."""

UNIT_LENGTH_TOLERANCE = 1e-9
"""Largest difference from 1 of the length of an axis that is used as a unit vector."""

NO_LIMIT = sys.float_info.max
"""Effort or velocity limit that urdf.save writes where the model has none.

The URDF schema demands both attributes in every <limit>, and <limit> for revolute and prismatic joints; urdfdom
(and so Pinocchio) refuses files without them. The largest double is a finite number that every reader accepts; zero
would mean that the joint cannot move.
"""

MIN_UNLIMITED = 1.79769e308
"""Magnitude from which a limit counts as none: SDFormat and others print the largest double with six digits."""

MAX_NUMBER = 1e60
"""Largest mass, tensor entry, length or angle [SI units]: products of several stay far below 1.8e308, the largest
double."""

MIN_AXIS_LENGTH = 1e-60
"""Length of an axis below which it is refused as zero: readers that square the length of a far shorter one get zero."""

UNEXPANDED_EXPRESSION = re.compile(r"\$[{(]")
"""Expressions that xacro would have replaced: ${…} and $(…)."""


@dataclass(frozen=True)
class BadNumber:
    """Why a text is not the numbers that were expected."""

    code: str
    problem: str
    remedy: str


def finite_number(text: str) -> float | None:
    """The number of a text, such as -1.5e-3; None for anything else, and for one beyond the largest double."""
    number = float(text) if _NUMBER.fullmatch(text) else math.nan
    return number if math.isfinite(number) else None


def numbers(text: str, count: int, said: str) -> list[float] | BadNumber:
    """The numbers of a text, which should be count, or what is wrong with it. said: the text as messages give it."""
    if UNEXPANDED_EXPRESSION.search(text):
        return BadNumber("unexpanded-number", f"{said} is not expanded", "expand the file with xacro")
    words = [word for word in _BLANKS.split(text) if word]
    if len(words) != count:
        problem, remedy = f"{said} has {len(words)} entries, expected {count}", "separate numbers by spaces"
        return BadNumber("wrong-number-of-entries", problem, remedy)
    for word in words:
        if word.lower().lstrip("+-") in ("nan", "inf", "infinity"):
            return BadNumber(
                "not-finite", f"{said} is not finite", "give a finite number, or leave it out where optional"
            )
        if not _NUMBER.fullmatch(word):
            return BadNumber("malformed-number", f"{said}: '{shortened(word)}' is not a number", "correct the number")
        if not math.isfinite(float(word)):
            return BadNumber("not-finite", f"{said}: '{shortened(word)}' overflows", "correct the number")
    return [float(word) for word in words]


def values(element: etree._Element | None, attribute: str, count: int) -> list[float] | None:
    """The numbers of an attribute; None where the element, the attribute or a valid number is missing."""
    text = None if element is None else element.get(attribute)
    found = None if text is None else numbers(text, count, "")
    return None if isinstance(found, BadNumber) else found


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """R (3, 3) of the three angles [rad]."""
    x, y, z = np.eye(3)
    return rotation_about(z, yaw) @ rotation_about(y, pitch) @ rotation_about(x, roll)


def rpy_from_rotation(rotation: Array) -> Array:
    """(roll, pitch, yaw) (3,) [rad], pitch in [-π/2, π/2], of a rotation (3, 3).

    Roll is taken from R_z(-yaw) R, so that the three angles are consistent: they reproduce the matrix to rounding even
    at pitch = ±π/2, where yaw alone is arbitrary. -0.0 becomes 0.0.
    """
    r = rotation
    yaw = np.arctan2(r[1, 0], r[0, 0])
    pitch = np.arctan2(-r[2, 0], np.hypot(r[0, 0], r[1, 0]))
    s, c = np.sin(yaw), np.cos(yaw)
    roll = np.arctan2(s * r[0, 2] - c * r[1, 2], c * r[1, 1] - s * r[0, 1])
    return np.array([roll, pitch, yaw]) + 0.0


def add_placement(element: etree._Element, placement: Placement) -> None:
    """<origin> of a frame."""
    add_origin(element, placement.translation, rpy_from_rotation(placement.rotation))


def add_origin(element: etree._Element, xyz: Array, rpy: Array) -> None:
    etree.SubElement(element, "origin", xyz=text(xyz), rpy=text(rpy))


def add_numbers(element: etree._Element, tag: str, values: Mapping[str, float]) -> None:
    etree.SubElement(element, tag, {name: repr(float(value)) for name, value in values.items()})


def inertial_element(body: Body) -> etree._Element:
    """<inertial> of a body, in link axes."""
    inertial = etree.Element("inertial")
    add_origin(inertial, body.center_of_mass, np.zeros(3))
    add_numbers(inertial, "mass", {"value": body.mass})
    entries = {
        f"i{'xyz'[row]}{'xyz'[column]}": body.inertia[row, column] for row in range(3) for column in range(row, 3)
    }
    add_numbers(inertial, "inertia", entries)
    return inertial


def text(values: Array) -> str:
    """Numbers as the shortest text that is read as the same doubles."""
    return " ".join(repr(float(value)) for value in np.asarray(values))
