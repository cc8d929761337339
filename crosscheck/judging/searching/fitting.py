"""Families of faults fitted to an observation: Gauss-Newton of many at once, with exact derivatives (complex steps)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.judging.faults.fault import COMPLEX_STEP, CodeFault
from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.judging.observing.observation import Observation
from graphdyn.layout import Array

MAX_FIT_ITERATIONS = 10
MAX_FITTED_FAMILIES = 60
"""Number of families, those that leave least, that are fitted beyond the first step."""

RANK_SHARE = 1e-9
"""Part of the largest singular value below which the data do not determine a direction."""

MAX_REMAINING_SHARE = 0.95
"""A step that leaves more than this part of the error is the last one."""


@dataclass(frozen=True, eq=False)
class Fitted:
    """A family with its numbers (p,), and the root mean square that it leaves."""

    family: CodeFault
    numbers: Array
    left: float


def root_mean_square(residuals: Array) -> Array:
    """Root mean square of each code (K,); infinite where an answer is not finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        size: Array = np.sqrt(np.mean(residuals.real**2, axis=(1, 2)))
    return np.where(np.isfinite(size), size, np.inf)


def fitted(families: Sequence[CodeFault], base: DynamicsCode, observation: Observation, noise: float) -> list[Fitted]:
    """Each family at the numbers that leave least, as far as it is among the better ones."""
    now = _started(families, base, observation)
    active = list(range(len(families)))
    for iteration in range(MAX_FIT_ITERATIONS):
        steps = _steps([now[k] for k in active], base, observation, noise)
        going = []
        for k, found in zip(active, steps, strict=True):
            if found.left < now[k].left:
                if found.left < MAX_REMAINING_SHARE * now[k].left and found.left > noise:
                    going.append(k)
                now[k] = found
        active = sorted(going, key=lambda k: now[k].left)[
            : MAX_FITTED_FAMILIES if iteration == 0 else MAX_FITTED_FAMILIES // 2
        ]
        if not active:
            break
    return now


def _started(families: Sequence[CodeFault], base: DynamicsCode, observation: Observation) -> list[Fitted]:
    starts = [family.right[None] if family.starts is None else family.starts for family in families]
    codes = [family.change(base, x) for family, xs in zip(families, starts, strict=True) for x in xs]
    left = root_mean_square(observation.residuals(codes))
    best, first = [], 0
    for family, xs in zip(families, starts, strict=True):
        k = int(left[first : first + len(xs)].argmin())
        best.append(Fitted(family, xs[k], float(left[first + k])))
        first += len(xs)
    return best


def _steps(now: Sequence[Fitted], base: DynamicsCode, observation: Observation, noise: float) -> list[Fitted]:
    """One step of each."""
    codes = [
        x.family.change(base, x.numbers + 1j * COMPLEX_STEP * direction)
        for x in now
        for direction in np.eye(len(x.numbers))
    ]
    with np.errstate(all="ignore"):
        residuals = observation.residuals(codes)
    tried, first = [], 0
    for x in now:
        p = len(x.numbers)
        columns = residuals[first : first + p].imag.reshape(p, -1).T / COMPLEX_STEP
        tried.append(x.numbers + _least_squares(columns, -residuals[first].real.ravel(), noise))
        first += p
    left = root_mean_square(observation.residuals([x.family.change(base, y) for x, y in zip(now, tried, strict=True)]))
    return [Fitted(x.family, y, float(size)) for x, y, size in zip(now, tried, left, strict=True)]


def _least_squares(columns: Array, target: Array, noise: float) -> Array:
    """The smallest solution, columns scaled to one length; zero where something is not finite."""
    if not (np.isfinite(columns).all() and np.isfinite(target).all()):
        return np.zeros(columns.shape[1])
    length = np.linalg.norm(columns, axis=0)
    length = np.where(length > 0, length, np.inf)
    solution: Array = np.linalg.lstsq(columns / length, target, rcond=max(RANK_SHARE, 10 * noise))[0] / length
    return solution


def effects(family: CodeFault, numbers: Array, base: DynamicsCode, observation: Observation) -> Array:
    """The largest change of an entry if each of the numbers is put right alone (p,)."""
    here = observation.residuals([family.change(base, numbers)])
    alone = [np.where(place, family.right, numbers) for place in np.eye(len(numbers), dtype=bool)]
    largest: Array = np.abs(observation.residuals([family.change(base, x) for x in alone]) - here).max(axis=(1, 2))
    return largest


def sparse(found: Fitted, base: DynamicsCode, observation: Observation, noise: float, bound: float) -> Fitted:
    """The fit with every number at its right value whose effect is below the bound, if that fits too."""
    if len(found.numbers) == 1 or found.left > bound:
        return found
    right = found.family.right
    kept = np.flatnonzero(effects(found.family, found.numbers, base, observation) > bound)
    if len(kept) == len(right):
        return found

    def filled(x: Array) -> Array:
        whole = right.astype(x.dtype)
        whole[kept] = x
        return whole

    fewer = CodeFault(
        right[kept],
        lambda code, x: found.family.change(code, filled(x)),
        lambda x: found.family.say(filled(x)),
        found.numbers[kept][None],
    )
    if not len(kept):
        return found
    (again,) = fitted([fewer], base, observation, noise)
    return Fitted(found.family, filled(again.numbers), again.left) if again.left <= bound else found
