"""Which of several right conventions the answers of a function under test follow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities import Quantity
from crosscheck.quantities.measures import Chosen
from graphdyn import InvalidInput
from graphdyn.layout import Array


@dataclass(frozen=True)
class FoundConventions:
    """How the answers of a function are read.

    chosen: the way that fits best
    fits: whether most answers agree when read like this
    said: what is found out for the reader, "link or world" where both fit; empty if none fits
    ours: graphdyn's answers, read as chosen                (N, …)
    """

    chosen: Chosen
    fits: bool
    said: Mapping[str, str]
    ours: Array


def found_conventions(
    function: Quantity, answer: Array, states: JudgedStates, declared: Chosen, tolerance: float
) -> FoundConventions:
    """The conventions with which most answers agree with graphdyn's; else those that are nearest to them.

    answer: (N, …); declared: conventions that are known
    """
    readings = list(function.readings(declared))
    ours = [function.of_graphdyn(states, chosen) for chosen in readings]
    errors = [relative_errors(function, answer, x, states, chosen) for x, chosen in zip(ours, readings, strict=True)]
    deviating = np.array([(error > tolerance).sum() for error in errors])
    middle = np.array([np.median(error) for error in errors])
    best = int(np.lexsort((middle, deviating))[0])
    if middle[best] > tolerance:
        return FoundConventions(readings[best], False, {}, ours[best])
    first = int(np.flatnonzero(deviating == deviating[best])[0])
    as_good = [chosen for chosen, count in zip(readings, deviating, strict=True) if count == deviating[best]]
    said = {
        name: " or ".join(way for way in ways if any(chosen[name] == way for chosen in as_good))
        for name, ways in function.conventions.items()
    }
    said |= {name: readings[first][name] for name in function.widening}
    return FoundConventions(readings[first], True, said, ours[first])


def relative_errors(function: Quantity, answer: Array, reference: Array, states: JudgedStates, chosen: Chosen) -> Array:
    """Relative errors (N,) on the scale of the function; entries that are not finite count as infinite."""
    return finite(function.judged_by(answer, reference, states, chosen))


def finite(errors: Array) -> Array:
    """Errors whose NaN count as infinite."""
    return np.where(np.isfinite(errors), errors, np.inf)


def check_declared(declared: Chosen, functions: list[Quantity]) -> None:
    """Raise InvalidInput for a convention that no judged function has, or a way that it does not know."""
    known: dict[str, tuple[str, ...]] = {}
    for function in functions:
        known.update(function.conventions)
    for name, way in declared.items():
        if name not in known:
            raise InvalidInput(
                f"convention {name!r} belongs to none of the functions to judge; they have {', '.join(known) or 'none'}"
            )
        if way not in known[name]:
            raise InvalidInput(f"convention {name!r} is {way!r}; give one of {', '.join(map(repr, known[name]))}")
