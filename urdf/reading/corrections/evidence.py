"""How far an inertial is from what is usual: beside the shape of its link, the other links, its neighbors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import exp, log

import numpy as np

from graphdyn.layout import Array
from urdf.document.inertial_numbers import InertialNumbers
from urdf.geometry.mass_properties import Filled

CLEARLY_POSITIVE = 1e-3
"""Smallest principal moment as a part of the largest from which a corrected tensor is clearly possible: thin rods have
more, and entries that change places by chance rarely leave as much."""


@dataclass(frozen=True)
class Usual:
    """What a measure is among links, and how far it strays."""

    middle: float
    spread: float


USUAL: Mapping[str, Usual] = {
    "form": Usual(0.0, 0.6),
    "scale": Usual(0.0, 0.6),
    "density": Usual(log(1000), 1.0),
    "offset": Usual(0.0, 0.2),
    "radius": Usual(log(0.4), 0.5),
    "mass": Usual(0.0, 0.9),
    "place": Usual(0.0, 0.7),
}
"""The measures of the links of published robots.

form: of the tensor beside that of the mesh, without its size: 0 where they agree
scale: logarithm of the gyration radius squared over that of the mesh
density: logarithm of mass over volume of the mesh
offset: center of mass from that of the mesh, over the longest side
radius: logarithm of the radius of gyration over the length of a link without a mesh
mass: logarithm of the mass over the geometric mean of those of the neighbors
place: logarithm of the distance of the center of mass from the origin of a link without a mesh, over the distance of
    its joints, or for a last link over that of others; zero where it is nearer
"""

MIN_LENGTH = 0.05
"""No link counts as shorter [m]."""

LEAST: Mapping[str, float] = {"form": 0.05, "scale": 0.05, "density": 0.5, "offset": 0.05, "radius": 0.4, "mass": 0.7}
"""Spread below which the measures of the other links of a robot agree by chance."""

ODD = 2.0
"""Spreads from the middle of all robots at which a robot is no measure of its links."""

MIN_OTHERS = 4
"""Number of different other links from which they say what is usual in their robot."""


@dataclass(frozen=True)
class LinkSurroundings:
    """filled: the shape of the link; neighbors: geometric mean of their masses [kg], None without any

    reach: distance of the farthest joint ahead, zero without one [m]; usual_reach: that of the other links
    """

    filled: Filled | None
    reach: float
    usual_reach: float
    neighbors: float | None

    def length(self, center: Array) -> float:
        """The length of the link, without a mesh [m]."""
        return max(MIN_LENGTH, self.reach, float(np.linalg.norm(center)))


def measures(inertial: InertialNumbers, around: LinkSurroundings) -> dict[str, float]:
    """The measures of USUAL that are there; those of the tensor of possible ones alone."""
    found: dict[str, float] = {}
    possible = inertial.is_possible(CLEARLY_POSITIVE)
    if around.neighbors is not None:
        found["mass"] = log(inertial.mass / around.neighbors)
    if around.filled is None:
        if possible and not inertial.is_placeholder:
            found["radius"] = log(np.sqrt(inertial.moments.sum() / 2 / inertial.mass) / around.length(inertial.center))
        away = float(np.linalg.norm(inertial.center))
        found["place"] = max(0.0, log(max(away, MIN_LENGTH) / max(around.reach, around.usual_reach)))
        return found
    solid = around.filled
    found["density"] = log(inertial.mass / solid.volume)
    found["offset"] = float(np.linalg.norm(inertial.center - solid.center) / (solid.high - solid.low).max())
    if possible:
        ratios = _logarithms(inertial.turned / inertial.mass, solid.tensor / solid.volume)
        found["scale"] = float(ratios.mean())
        found["form"] = float(np.linalg.norm(ratios - ratios.mean()))
    return found


def _logarithms(one: Array, other: Array) -> Array:
    """The logarithms of the eigenvalues of a tensor relative to another, both positive definite (3,)."""
    found: Array = np.log(np.linalg.eigvals(np.linalg.solve(other, one)).real)
    return found


def usual_among(others: Sequence[Mapping[str, float]]) -> dict[str, Usual]:
    """What is usual among the other links of a robot, and where they are few, among all robots.

    Where a robot as a whole is far from all others, each of its links may be as far from the others.
    """
    found = dict(USUAL)
    different = {tuple(round(value, 3) for value in each.values()): each for each in others}.values()
    for name in USUAL:
        values = np.array([each[name] for each in different if name in each])
        if len(values) < MIN_OTHERS or name in ("mass", "radius", "place"):
            continue
        middle = 0.0 if name in ("form", "offset") else float(np.median(values))
        stray = np.median(np.abs(values - middle)) * (1.0 if middle == 0 else 1.48) * (1 + 2 / len(values))
        far = abs(middle - USUAL[name].middle)
        found[name] = Usual(middle, max(float(stray), LEAST[name], far if far > ODD * USUAL[name].spread else 0.0))
    return found


def strangeness(found: Mapping[str, float], usual: Mapping[str, Usual]) -> float:
    """Sum of the squares of the measures, each over its spread."""
    return sum(((value - usual[name].middle) / usual[name].spread) ** 2 for name, value in found.items())


def worst(inertial: InertialNumbers, around: LinkSurroundings, usual: Mapping[str, Usual]) -> str:
    """The measure that is farthest from what is usual, in words."""
    found = measures(inertial, around)
    name = max(found, key=lambda name: abs(found[name] - usual[name].middle) / usual[name].spread)
    factor, middle = exp(found[name]), exp(usual[name].middle)
    return {
        "form": "the tensor is unlike that of its shape",
        "scale": f"the tensor is {factor:.3g} times that of its shape with this mass",
        "density": f"{factor:.3g} kg/m³ in its shape, where {middle:.3g} is usual",
        "offset": "the center of mass is far from that of its shape",
        "radius": f"the radius of gyration is {factor:.3g} times the length of the link",
        "place": f"the center of mass is {factor:.3g} times as far away as the joints",
        "mass": f"{factor:.3g} times the mass of its neighbors",
    }[name]
