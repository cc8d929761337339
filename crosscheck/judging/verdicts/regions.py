"""The region of the states at which a function deviates: beyond limits, or beyond thresholds of one or two quantities.

All thresholds of all quantities are tried, of one and of two at a time: a decision tree of two levels, found
exhaustively. A library of decision trees grows the same tree greedily, and is a heavy dependency for these few lines.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.calls.beyond_limits import beyond_limits
from crosscheck.judging.special_states import ONE_JOINT, OTHER_STATES
from crosscheck.judging.states import JudgedStates
from graphdyn.layout import Array

MAX_CHANCE_PROBABILITY = 1e-3
"""Largest probability that states drawn without any rule would be separated as well."""

UNIT_SUFFIXES = {"q": "", "v": "/s", "a": "/s²"}


@dataclass(frozen=True, eq=False)
class RegionVariable:
    """A number of each state, in which a region may be bounded.

    name: in words; values: (N,); unit: with a blank before it, or ""
    limit: of this quantity, None where there is none
    """

    name: str
    values: Array
    unit: str
    limit: float | None = None


@dataclass(frozen=True, eq=False)
class Side:
    """One side of a threshold: all states that deviate, and others.

    inside: the states on this side (N,)
    """

    quantity: RegionVariable
    above: bool
    inside: NDArray[np.bool_]

    def said(self, among: NDArray[np.bool_]) -> str:
        """Such as "q of joint 'elbow' > 2 rad", "∣v∣ of joint 'elbow' > 2.4 rad/s (80 % of its limit)".

        among: the states that tell where the threshold is (N,)
        """
        values, limit = self.quantity.values, self.quantity.limit
        sign = 1.0 if self.above else -1.0
        x, y = sign * (sign * values[self.inside]).min(), sign * (sign * values[among & ~self.inside]).max()
        edge, part = roundest(x, y), ""
        if limit:
            percent = roundest(100 * x / limit, 100 * y / limit)
            edge, part = percent * limit / 100, f" ({percent:.12g} % of its limit)"
        return f"{self.quantity.name} {'>' if self.above else '<'} {edge:.6g}{self.quantity.unit}{part}"


def region(deviating: NDArray[np.bool_], states: JudgedStates, arguments: Collection[str]) -> str | None:
    """The region of the deviating states, in words; None where that has no such form, or may be chance.

    arguments: of the function
    """
    in_motion = ~np.isin(np.broadcast_to(states.labels, len(deviating)), (OTHER_STATES, ONE_JOINT))
    deviating, states = deviating[in_motion], states.rows(in_motion)  # at rest some function vanishes, right or wrong
    if said := beyond_limits(deviating, states, arguments):
        return said
    if deviating[states.ordinary].all():  # special states may be right by chance
        return None
    count, total = int(deviating.sum()), len(deviating)
    if not 0 < count < total:
        return None
    known = list(quantities(states, arguments))
    sides = [side for quantity in known for side in _sides(quantity, deviating)]
    by_chance = 1 / comb(total, count)  # that the deviating states are those beyond some threshold of one quantity
    if 2 * len(known) * by_chance > MAX_CHANCE_PROBABILITY:
        return None
    single = [side for side in sides if np.array_equal(side.inside, deviating)]
    if single:
        return single[0].said(np.ones(total, dtype=bool))
    if (2 * len(known)) ** 2 * total * by_chance > MAX_CHANCE_PROBABILITY:
        return None
    pairs = ((x, y) for x, y in combinations(sides, 2) if np.array_equal(x.inside & y.inside, deviating))
    found = next(pairs, None)
    if found is None:
        return None
    x, y = found
    return f"{x.said(y.inside)} and {y.said(x.inside)}"


def _sides(quantity: RegionVariable, deviating: NDArray[np.bool_]) -> Iterator[Side]:
    """The tightest threshold from either side that has all deviating states beyond it."""
    for above, values in ((True, quantity.values), (False, -quantity.values)):
        inside = values >= values[deviating].min()
        if not inside.all():
            yield Side(quantity, above, inside)


def quantities(states: JudgedStates, arguments: Collection[str]) -> Iterator[RegionVariable]:
    """Position, velocity, acceleration and speed of each joint; the largest of all joints."""
    model, moving = states.model, [name for name in "qva" if name in arguments]
    speed = np.array([joint.limits.velocity or np.nan for joint in model.joints])
    for k, joint in enumerate(model.joints):
        for name in moving:
            values, unit = getattr(states, name)[:, k], f" {'m' if joint.is_prismatic else 'rad'}{UNIT_SUFFIXES[name]}"
            limit = float(speed[k]) if name == "v" and speed[k] > 0 else None
            yield RegionVariable(f"{name} of joint '{joint.name}'", values, unit)
            yield RegionVariable(f"∣{name}∣ of joint '{joint.name}'", np.abs(values), unit, limit)
    if "v" in moving and (speed > 0).all():
        fastest = (np.abs(states.v) / speed).max(axis=1) * 100
        yield RegionVariable("the largest speed of a joint", fastest, " % of its limit")
    for name in moving:
        yield RegionVariable(f"the largest ∣{name}∣ of a joint", np.abs(getattr(states, name)).max(axis=1), "")


def roundest(x: float, y: float) -> float:
    """The roundest number between two numbers: a multiple of as large a power of ten as can be, or of half of one."""
    lower, upper = min(x, y), max(x, y)
    for digits in range(-6, 16):
        for step in (10.0**-digits, 0.5 * 10.0**-digits):
            rounded = round(float(np.ceil(lower / step)) * step, max(digits + 1, 0))
            if rounded <= upper:
                return rounded + 0.0  # not -0
    return lower
