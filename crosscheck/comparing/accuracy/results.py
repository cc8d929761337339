"""What is known of the accuracy of codes: plain data, errors in eps of the scale of each quantity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.exact import Truth
from crosscheck.quantities.states import RANDOM
from crosscheck.reference.subject import OfReading
from graphdyn import RobotModel
from graphdyn.display import Displayed
from graphdyn.layout import Array
from urdf import Reading

HIGH_QUANTILE = 0.99
"""Probability of CodeErrors.quantile_99."""

PINOCCHIO, MUJOCO = "Pinocchio", "MuJoCo"
"""Names of the codes that are not methods of graphdyn."""

SMALLEST_RATIO = 1e-3
"""Ratios of errors below this count as this in a geometric mean: zero would hide all others."""


@dataclass(frozen=True, eq=False)
class CodeErrors:
    """How far one code is from the exact values of a quantity, in eps = 2.2e-16.

    by_case: the errors at every state of each kind, relative to the scale of the quantity, and to the largest exact
        value at the state; NaN counts as infinite     (2, N) each
    """

    by_case: Mapping[str, Array]

    @property
    def median(self) -> float:
        """Median at random states, of the scale."""
        return self._quantile(0.5)

    @property
    def quantile_99(self) -> float:
        """What 99 % of the errors at random states do not exceed, of the scale; an error that occurred."""
        return self._quantile(HIGH_QUANTILE)

    @property
    def largest(self) -> float:
        """Largest error at all states, of the scale."""
        return max(self.largest_by_case.values())

    @property
    def worst_case(self) -> str:
        """The kind of state at which it occurs."""
        found = self.largest_by_case
        return max(found, key=lambda case: found[case])

    @property
    def largest_by_case(self) -> dict[str, float]:
        """Largest error at each kind of state, of the scale."""
        return {case: float(errors[0].max()) for case, errors in self.by_case.items()}

    @property
    def quantile_99_of_values(self) -> float:
        """The 99 % quantile at random states, relative to the largest exact value at each."""
        return self._quantile(HIGH_QUANTILE, of_values=True)

    def _quantile(self, part: float, of_values: bool = False) -> float:
        return float(np.quantile(self.by_case[RANDOM][int(of_values)], part, method="higher"))


@dataclass(frozen=True, eq=False)
class QuantityErrors:
    """One quantity, by all codes that compute it.

    name: that of the cross-check, with `_external` for external wrenches
    bound: what the cross-check allows, in eps of the scale
    scale: besides the largest exact value, what errors are relative to, in the terms of docs/notation.md
    states: number of states, random and special ones
    codes: errors by code: "recursive", "projected", "dense" are methods of graphdyn; "Pinocchio", "MuJoCo"
    """

    name: str
    bound: float
    scale: str
    states: int
    codes: Mapping[str, CodeErrors]

    @property
    def beyond(self) -> tuple[str, ...]:
        """The codes whose largest error exceeds the bound."""
        return tuple(name for name, code in self.codes.items() if not code.largest <= self.bound)

    def ratios(self, code: str, other: str) -> tuple[float, float]:
        """The 99 % quantile of one code over that of another, of the scale and of the largest values; 1 where both
        vanish."""
        one, two = self.codes[code], self.codes[other]
        pairs = (one.quantile_99, two.quantile_99), (one.quantile_99_of_values, two.quantile_99_of_values)
        first, second = (x / y if y > 0 else 1.0 if x == 0 else np.inf for x, y in pairs)
        return first, second


@dataclass(frozen=True, eq=False, repr=False)
class TrueErrors(OfReading, Displayed):
    """The accuracy of graphdyn and of the reference implementations on one robot.

    robot: name or path as given
    file: path of its URDF; None where a RobotModel was given
    file_sha256: SHA-256 of the content of that file, in hexadecimal; None where a RobotModel was given
    model: the robot that was measured
    n_bodies: moving bodies, and joints
    samples: random states; the special ones come on top
    seed: of the random states
    reading: how the file was read
    truth: what the exact values are those of: the decimals of the file, or the doubles of the model in memory
    compiled: whether the recursive method was compiled at the random states; else it ran on NumPy
    quantities: what was measured, by name, in the order of the table (docs/notation.md)
    not_measured: quantities left out, with the reason
    not_regular: number of states of each kind at which forward dynamics was left out: the mass matrix is not proven
        regular, or is singular in double precision
    notes: what the reader must know
    """

    robot: str
    file: str | None
    file_sha256: str | None
    model: RobotModel
    n_bodies: int
    samples: int
    seed: int
    reading: Reading
    truth: Truth
    compiled: bool
    quantities: Mapping[str, QuantityErrors]
    not_measured: Mapping[str, str]
    not_regular: Mapping[str, int]
    notes: tuple[str, ...]

    def summary(self) -> str:
        """Which codes exceed the bound of a quantity."""
        beyond = [f"{name}: {', '.join(one.beyond)}" for name, one in self.quantities.items() if one.beyond]
        return (
            f"{self.robot} against exact values: {len(self.quantities)} quantities at {self.samples} random states and "
            f"special ones; {'beyond their bounds: ' + '; '.join(beyond) if beyond else 'all within their bounds'}"
        )

    @property
    def agrees(self) -> bool:
        """Whether no code exceeds the bound of any quantity."""
        return not any(quantity.beyond for quantity in self.quantities.values())


@dataclass(frozen=True)
class ErrorRatio:
    """The 99 % quantiles of a code over those of Pinocchio, of several robots.

    mean: geometric; largest, robot: of all, and whose
    mean_of_values, largest_of_values: of errors relative to the largest exact value at each state
    """

    mean: float
    largest: float
    robot: str
    mean_of_values: float
    largest_of_values: float


def over_robots(measured: Sequence[TrueErrors]) -> dict[str, dict[str, ErrorRatio]]:
    """How the errors of every other code compare with those of Pinocchio, by quantity and code."""
    names = dict.fromkeys(name for one in measured for name in one.quantities)
    return {
        name: _ratios([(one.robot, one.quantities[name]) for one in measured if name in one.quantities])
        for name in names
    }


def _ratios(found: Sequence[tuple[str, QuantityErrors]]) -> dict[str, ErrorRatio]:
    codes = dict.fromkeys(code for _, quantity in found for code in quantity.codes if code != PINOCCHIO)
    ratios = {}
    for code in codes:
        having = [(robot, quantity.ratios(code, PINOCCHIO)) for robot, quantity in found if code in quantity.codes]
        pairs = np.array([pair for _, pair in having])
        means = np.exp(np.log(np.maximum(pairs, SMALLEST_RATIO)).mean(axis=0))
        worst = int(pairs[:, 0].argmax())
        ratios[code] = ErrorRatio(
            float(means[0]), float(pairs[worst, 0]), having[worst][0], float(means[1]), float(pairs[:, 1].max())
        )
    return ratios
