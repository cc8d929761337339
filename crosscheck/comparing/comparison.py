"""The answer of a cross-check: plain data, and whether the two codes agree."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crosscheck.comparing.baseline import BaselineIdentification
from crosscheck.comparing.conditioning import Conditioning
from crosscheck.quantities import ComparedQuantity
from crosscheck.reference.subject import OfReading
from graphdyn import RobotModel
from graphdyn.display import Displayed, short_repr
from graphdyn.layout import Array
from graphdyn.tables import data_frame
from urdf import Reading

if TYPE_CHECKING:
    import pandas

QUANTILES = (0.0, 0.5, 0.9, 0.99, 1.0)
"""Probabilities of QuantityResult.quantiles."""


def part_of_bound(error: float, bound: float) -> float:
    """Error over bound; for a bound of zero, zero without an error and else infinite."""
    if bound == 0:
        return math.inf if error > 0 else 0.0
    return error / bound


@dataclass(frozen=True)
class WorstState:
    """The state at which an error is largest, with the numbers to reproduce it.

    route: of this error; case: kind of state
    q, v, a: joint positions, velocities, accelerations (n,) [rad or m, …/s, …/s²]
    tau: given torques or forces; None for the torques that cause a (n,) [N m or N]
    external_wrenches: force, then moment, on each body at its link origin, in link axes (n, 6) [N, N m]
    turn: rotation of base and gravity in the world (3, 3)
    gravity: in this case, world axes (3,) [m/s²]
    """

    route: str
    case: str
    q: tuple[float, ...]
    v: tuple[float, ...]
    a: tuple[float, ...]
    tau: tuple[float, ...] | None
    external_wrenches: tuple[tuple[float, ...], ...]
    turn: tuple[tuple[float, ...], ...]
    gravity: tuple[float, ...]


@dataclass(frozen=True, eq=False)
@short_repr
class QuantityResult:
    """One quantity over all routes, cases and samples.

    errors: of every route and state, in the order of computation; NaN counts as infinite   (N,)
    max_relative_error: the largest of them, on the scale of crosscheck.quantities
    by_case: largest relative error of each kind of state
    by_route: largest relative error of each route
    worst: where the error is largest; None where the error belongs to all states together
    """

    quantity: ComparedQuantity
    errors: Array
    max_relative_error: float
    by_case: Mapping[str, float]
    by_route: Mapping[str, float]
    worst: WorstState | None

    @property
    def agrees(self) -> bool:
        """Whether the largest error is within the bound."""
        return self.max_relative_error <= self.quantity.tolerance.bound

    @property
    def part_of_bound(self) -> float:
        """How much of its bound the largest error takes."""
        return part_of_bound(self.max_relative_error, self.quantity.tolerance.bound)

    @property
    def quantiles(self) -> dict[str, float]:
        """Quantiles of the errors by probability (QUANTILES); each is an error that occurred."""
        ordered = np.sort(self.errors)
        ranks = np.ceil(np.array(QUANTILES) * (len(ordered) - 1)).astype(int)
        return {f"{part:g}": float(ordered[rank]) for part, rank in zip(QUANTILES, ranks, strict=True)}


@dataclass(frozen=True, eq=False, repr=False)
class Comparison(OfReading, Displayed):
    """The verdict on one robot.

    robot: name or path as given
    file: path of its URDF; None where a RobotModel was given
    file_sha256: SHA-256 of the content of that file, in hexadecimal; None where a RobotModel was given
    model: the robot that was compared
    n_bodies: moving bodies, and joints
    samples: random states; the awkward ones come on top
    seed: of the random states
    reading: how the file was read
    quantities: what was compared, by name, in the order of the table (docs/notation.md)
    not_compared: quantities left out, with the reason
    routes: "urdf" (Pinocchio reads the same file), "model" (Pinocchio's model is built from ours)
    identification: of base parameters from simulated torques; None where no body has mass
    notes: what the reader must know (a file that Pinocchio refused, …)
    """

    robot: str
    file: str | None
    file_sha256: str | None
    model: RobotModel
    n_bodies: int
    samples: int
    seed: int
    reading: Reading
    routes: tuple[str, ...]
    quantities: Mapping[str, QuantityResult]
    not_compared: Mapping[str, str]
    conditioning: Conditioning
    identification: BaselineIdentification | None
    notes: tuple[str, ...]

    def summary(self) -> str:
        """The verdict, and how far from their bounds the errors are."""
        results = list(self.quantities.values())
        within = sum(result.agrees for result in results)
        worst = max(results, key=lambda result: result.part_of_bound)
        beyond = [result.quantity.name for result in results if not result.agrees]
        lines = [
            f"{self.robot} {'agrees' if self.agrees else 'DISAGREES'} with Pinocchio: {within} of {len(results)} "
            f"quantities within their bounds, at {self.samples} random states and special ones (seed {self.seed})",
            f"nearest to its bound: {worst.quantity.name}, {worst.max_relative_error:.1e} of "
            f"{worst.quantity.tolerance.bound:.1e}"
            if not beyond
            else f"beyond their bounds: {', '.join(beyond)}",
        ]
        return "\n".join([*lines, *self.notes])

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every quantity: whether it agrees, its error and bound, and where the error is largest.

        Raises ImportError where pandas is missing.
        """
        results = list(self.quantities.values())
        columns = {
            "agrees": [result.agrees for result in results],
            "error": [result.max_relative_error for result in results],
            "bound": [result.quantity.tolerance.bound for result in results],
            "part of bound": [result.part_of_bound for result in results],
            "worst at": [result.worst.case if result.worst else None for result in results],
            "route": [result.worst.route if result.worst else None for result in results],
        }
        return data_frame(columns, list(self.quantities), "quantity")

    @property
    def agrees(self) -> bool:
        """Whether every quantity agrees."""
        return all(result.agrees for result in self.quantities.values())
