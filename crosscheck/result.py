"""The answer of a cross-check: plain data that judges itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from crosscheck.baseline import Identification
from crosscheck.quantities import Conditioning, Quantity


@dataclass(frozen=True)
class WorstState:
    """Where an error is largest, with the numbers to reproduce it."""

    route: str
    case: str
    q: tuple[float, ...]
    v: tuple[float, ...]
    a: tuple[float, ...]


@dataclass(frozen=True)
class QuantityResult:
    """One quantity over all routes, cases and samples.

    max_relative_error: largest error on the scale of crosscheck.quantities; NaN counts as infinite
    by_case: largest error of each case; by_route: of each route
    """

    quantity: Quantity
    max_relative_error: float
    by_case: Mapping[str, float]
    by_route: Mapping[str, float]
    worst: WorstState | None

    @property
    def agrees(self) -> bool:
        return self.max_relative_error <= self.quantity.tolerance.bound


@dataclass(frozen=True)
class Comparison:
    """The verdict on one robot.

    quantities: by name, in the order of the table
    not_compared: quantities left out, with the reason
    routes: "urdf" (Pinocchio builds the same file), "model" (Pinocchio is built from our model)
    notes: what the reader must know (a route that Pinocchio refused, …)
    """

    robot: str
    n_bodies: int
    samples: int
    seed: int
    locked: Mapping[str, float]
    routes: tuple[str, ...]
    quantities: Mapping[str, QuantityResult]
    not_compared: Mapping[str, str]
    conditioning: Conditioning
    identification: Identification | None
    notes: tuple[str, ...]

    @property
    def agrees(self) -> bool:
        return all(result.agrees for result in self.quantities.values())
