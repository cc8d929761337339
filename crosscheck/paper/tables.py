"""Table 2 (masses and moments of inertia from the geometry), and the motion of section 3.1 at one instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.paper.printed import TABLE_2, Printed
from graphdyn import BaseMotion, kr500, kr500_experiment
from graphdyn.experiments import BODY_LENGTHS, BODY_RADII, RAIL_ACCELERATION
from graphdyn.layout import Array

WHY_TABLE_2 = (
    "Nothing differs: homogeneous steel cylinders of 7801 kg/m³ give every printed digit. The row labels J_i1 and J_i2 "
    "of the paper are J_11 and J_22 (B8)."
)


@dataclass(frozen=True, eq=False)
class GeometryTable:
    """Table 2 and the cylinder formula; rows as printed, first the lengths and radii, which are given.

    ours: not rounded                                       (6, 6)  [m, kg, kg m²]
    """

    rows: tuple[str, ...]
    printed: tuple[tuple[Printed, ...], ...]
    ours: Array

    @property
    def texts(self) -> tuple[tuple[str, ...], ...]:
        """Our numbers with the decimal places of the paper."""
        return tuple(
            tuple(f"{value:.{_places(number)}f}" for value, number in zip(values, numbers, strict=True))
            for values, numbers in zip(self.ours, self.printed, strict=True)
        )

    @property
    def differing(self) -> int:
        """Number of entries that differ in any printed digit."""
        return sum(
            text != number.text
            for texts, numbers in zip(self.texts, self.printed, strict=True)
            for text, number in zip(texts, numbers, strict=True)
        )


def geometry_table() -> GeometryTable:
    """Table 2 of graphdyn.kr500()."""
    bodies = kr500().bodies
    moments = np.array([np.diag(body.inertia) for body in bodies]).T
    ours = np.vstack([BODY_LENGTHS, BODY_RADII, [body.mass for body in bodies], moments])
    return GeometryTable(tuple(TABLE_2.rows), tuple(TABLE_2.rows.values()), ours)


def _places(number: Printed) -> int:
    return len((number.text or "").partition(".")[2])


ALONG_THE_RAIL = np.array([1.0, 0.0, 0.0])


def joint_motion(time: float) -> tuple[Array, Array, Array]:
    """q, v, a (6,) at a time [s]."""
    recording = kr500_experiment([time])
    return recording.q[0], recording.v[0], recording.a[0]


def rail(time: float) -> BaseMotion:
    """The carriage at a time [s], from rest."""
    speed, acceleration = np.zeros(6), np.zeros(6)
    speed[:3], acceleration[:3] = RAIL_ACCELERATION * time * ALONG_THE_RAIL, RAIL_ACCELERATION * ALONG_THE_RAIL
    path = RAIL_ACCELERATION * time**2 / 2 * ALONG_THE_RAIL
    return BaseMotion(translation=path, velocity=speed, acceleration=acceleration)
