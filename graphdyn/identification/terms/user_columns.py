"""User-defined torques: springs, counterbalances, cables."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.term import TermParameter
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

Law = Callable[[Array, Array, Array], Array]
"""A function of q, v, a (N, n)."""


@dataclass(frozen=True, eq=False)
@short_repr
class UserColumns:
    """k unknown parameters with user-defined columns.

    law: (q, v, a) → (N, n, k), or (N, n) for one column; row by row, without memory of earlier samples
    names, units: k of each
    """

    law: Law
    names: Sequence[str]
    units: Sequence[str]

    def __post_init__(self) -> None:
        if isinstance(self.names, str) or isinstance(self.units, str) or len(self.names) != len(self.units):
            raise InvalidInput(f"names are {self.names!r}, units {self.units!r}; give one list entry each per column")

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return tuple(TermParameter(name, name, unit) for name, unit in zip(self.names, self.units, strict=True))

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        expected = (*samples.q.shape, len(self.names))
        rows = _answer(f"the law of {', '.join(self.names)}", self.law, samples)
        if rows.ndim == 2 and len(self.names) == 1:
            rows = rows[..., None]
        return _checked(f"the law of {', '.join(self.names)}", rows, expected)


@dataclass(frozen=True, eq=False)
class ScaledTorque:
    """A torque (q, v, a) → (N, n) [N m or N] of known form and unknown scale: a spring, a gas spring, a counterbalance.

    name: of the factor, which is 1 if the law is exact
    """

    law: Law
    name: str = "scale"

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return (TermParameter(f"{self.name} factor", self.name, "1"),)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        who = f"the torque '{self.name}'"
        return _checked(who, _answer(who, self.law, samples), samples.q.shape)[..., None]


@dataclass(frozen=True, eq=False)
class KnownTorque:
    """A known torque (q, v, a) → (N, n) [N m or N] that the drives supply in addition; it is subtracted.

    The torque of a counterbalance that relieves the drives is negative.
    """

    law: Law

    def torque(self, model: RobotModel, samples: Samples) -> Array:
        return _checked("the known torque", _answer("the known torque", self.law, samples), samples.q.shape)


def _answer(who: str, law: Law, samples: Samples) -> Array:
    return as_floats(who, law(*(np.asarray(x, dtype=float) for x in (samples.q, samples.v, samples.a))))


def _checked(who: str, rows: Array, expected: tuple[int, ...]) -> Array:
    if rows.shape != expected or not np.all(np.isfinite(rows)):
        what = f"shape {rows.shape}" if rows.shape != expected else "NaN or infinity"
        raise InvalidInput(f"{who} answers {what}; finite numbers of shape {expected} needed")
    return rows
