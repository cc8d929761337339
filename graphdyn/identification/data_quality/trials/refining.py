"""Search for the sizes of changes, and for gravity: valleys of the criterion, their bottoms and standard deviations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.causes.changes import Change, ChangeKind, RecordedColumns
from graphdyn.identification.data_quality.causes.gravity import gravity_of_cad
from graphdyn.identification.data_quality.causes.sizes import SizedChange
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.identification.data_quality.fits.free_fit import free_misfits
from graphdyn.identification.data_quality.fits.size_deviation import covariance
from graphdyn.identification.data_quality.trials.trials import (
    MIN_HINT_GAIN,
    MIN_MISFIT_RISE,
    ChangeTrial,
    Part,
    fit_of,
    misfit_of,
    trial,
    worth_from,
)
from graphdyn.layout import Array
from graphdyn.model.robot_model import STANDARD_GRAVITY

MAX_GRAVITY_VARIATION = 0.01
"""Relative difference from standard gravity from which it is not that of a place on Earth, where it varies by 0.5 %."""

MAX_REFINED = 6
"""Largest number of changes of unknown size that are refined, those that promise most."""

SIZE_TOLERANCE = 1e-3
"""Precision of the search for a size, relative to the distance of the sizes that are tried."""

MAX_ROUNDING_LOSS = 0.05
"""Loss of Σ log ‖e_j‖ below which a round size is taken in place of the best one."""

STEP_OF_SIZE = 1e-3
"""Step of the difference quotient over a size, relative to the largest that is tried."""


@dataclass(frozen=True, eq=False)
class Curve:
    """The rise of the criterion if a size is changed.

    change: whose size; sizes: tried, increasing (k,); rises: of Σ log ‖e_j‖ without bounds (k,), 0 for no change
    """

    change: SizedChange
    sizes: tuple[float, ...]
    rises: Array

    @property
    def best(self) -> int:
        """Number of the size with the lowest criterion."""
        return int(np.argmin(self.rises))

    @property
    def shows_small_sizes(self) -> bool:
        """Whether the smallest sizes beside no change raise the criterion, on one side at least."""
        here = self.sizes.index(self.change.unchanged)
        return bool(max(self.rises[here - 1], self.rises[here + 1]) > MIN_HINT_GAIN)


def curves(part: Part, columns: RecordedColumns, considered: Sequence[SizedChange]) -> list[Curve]:
    """The criterion over the size of each change, on some of the rows; finely where the recording shows small sizes."""
    few = part.screened

    def rises(asked: Sequence[tuple[SizedChange, tuple[float, ...]]]) -> list[Array]:
        each = [change.of(size) for change, sizes in asked for size in sizes]
        values = np.empty(len(each))
        moving = [k for k, change in enumerate(each) if change.moves]
        values[moving] = free_misfits([few.after(each[k], columns) for k in moving])
        for k in set(range(len(each))) - set(moving):
            values[k] = few.free_fit.misfit_of_torques(each[k].applied(few.samples, columns).tau)
        return np.split(values - few.misfit, np.cumsum([len(sizes) for _, sizes in asked])[:-1])

    coarse = [(change, tuple(size for size in change.tried if size != change.unchanged)) for change in considered]
    found = [_curve(change, sizes, own) for (change, sizes), own in zip(coarse, rises(coarse), strict=True)]
    finer = [(curve.change, curve.change.fine) for curve in found if curve.shows_small_sizes]
    if not finer:
        return found
    own = dict(zip([id(change) for change, _ in finer], rises(finer), strict=True))
    return [_with_fine(curve, own[id(curve.change)]) if id(curve.change) in own else curve for curve in found]


def _curve(change: SizedChange, sizes: Sequence[float], rises: Array) -> Curve:
    """The curve with no change in its place."""
    every = np.append(sizes, change.unchanged)
    order = np.argsort(every)
    return Curve(change, tuple(every[order].tolist()), np.append(rises, 0.0)[order])


def _with_fine(curve: Curve, rises: Array) -> Curve:
    changed = [k for k, size in enumerate(curve.sizes) if size != curve.change.unchanged]
    sizes = [*(curve.sizes[k] for k in changed), *curve.change.fine]
    return _curve(curve.change, sizes, np.append(curve.rises[changed], rises))


def refined(part: Part, columns: RecordedColumns, found: Sequence[Curve], gained: float = 0.0) -> Iterator[ChangeTrial]:
    """Trials of the changes of unknown size that promise a gain, each of the best size.

    gained: what the best of the other changes gains
    """
    least = max(MIN_HINT_GAIN, worth_from(max((gained, *(-curve.rises.min() for curve in found)))))
    promising = sorted((curve for curve in found if -curve.rises.min() > least), key=lambda c: c.rises.min())
    before = part.fit.errors(part.samples.tau)
    for curve in promising[:MAX_REFINED]:
        change, low, high = curve.change, *_neighbors(curve)
        size = _best_size(part.screened, columns, change, low, high)
        best = trial(part, change.of(size), columns, before)
        if best is None:
            continue
        for round_size in change.round_sizes:
            other = trial(part, change.of(round_size), columns, before) if low <= round_size <= high else None
            if other is not None and other.gained > best.gained - MAX_ROUNDING_LOSS:
                size, best = round_size, other
        yield replace(best, deviation_of_size=partial(_size_deviation, part, columns, change, size))


def tried_gravity(part: Part, min_gain: float = MIN_HINT_GAIN) -> Iterator[ChangeTrial]:
    """Trials of gravity: none, if it was subtracted; that on Earth, if the model's has another size; the one that
    explains the torques best, and the one with which CAD does, if the former promises this gain."""
    few = part.screened
    given = np.asarray(part.torque_model.model.gravity, dtype=float)
    size, standard = float(np.linalg.norm(given)), float(np.linalg.norm(STANDARD_GRAVITY))
    if size > 0 and (none := _trial_of_gravity(part, np.zeros(3), "gravity subtracted")) is not None:
        yield none
    if size > 0 and abs(size / standard - 1) > MAX_GRAVITY_VARIATION:
        there = _trial_of_gravity(part, standard / size * given)
        if there is not None:
            yield there
    gravity, lower = few.gravity_fit.best()
    if few.misfit - lower <= min_gain:
        return
    for found in (gravity, gravity_of_cad(few.torque_model, few.samples, few.fit)):
        best = _trial_of_gravity(part, found)
        if best is None:
            continue
        if size > 0:  # an error of its size is rare, and hard to tell from one of the clock
            rotated = _trial_of_gravity(part, size * found / np.linalg.norm(found))
            best = rotated if rotated is not None and rotated.gained > best.gained - MIN_MISFIT_RISE else best
        yield replace(best, deviation_of_size=partial(_gravity_deviation, part, best.change))


def _trial_of_gravity(part: Part, gravity: Array, kind: ChangeKind = "gravity") -> ChangeTrial | None:
    n, before = part.samples.q.shape[1], part.fit.errors(part.samples.tau)
    return trial(part, Change(kind, tuple(range(n)), gravity=gravity), RecordedColumns.of_joints(n), before)


def _neighbors(curve: Curve) -> tuple[float, float]:
    """The tried sizes on both sides of the best one."""
    k = curve.best
    return curve.sizes[max(0, k - 1)], curve.sizes[min(len(curve.sizes) - 1, k + 1)]


def _best_size(few: Part, columns: RecordedColumns, change: SizedChange, low: float, high: float) -> float:
    """The size with the smallest criterion between two."""
    from scipy.optimize import minimize_scalar

    def misfit(size: float) -> float:
        model, samples, kept = few.after(change.of(size), columns)
        fit = fit_of((model, samples, kept))
        return np.inf if fit is None else misfit_of(fit, samples.tau)

    tolerance = SIZE_TOLERANCE * (high - low)
    return float(minimize_scalar(misfit, bounds=(low, high), method="bounded", options={"xatol": tolerance}).x)


def _size_deviation(part: Part, columns: RecordedColumns, change: SizedChange, size: float) -> float:
    step = STEP_OF_SIZE * max(map(abs, change.tried))
    here = _refitted(part, change.of(size), columns)
    below, above = (_refitted(part, change.of(x), columns) for x in (size - step, size + step))
    if here is None or below is None or above is None:
        return float("nan")
    fit, samples = here
    x = fit.parameters(samples.tau)
    slope = (_residual(above, x) - _residual(below, x)) / (2 * step)
    return float(np.sqrt(covariance(fit, fit.residual(samples.tau, x), slope[None])[0, 0]))


def _gravity_deviation(part: Part, change: Change) -> float:
    """Standard deviation of the direction of gravity [°], the larger of its two."""
    assert change.gravity is not None
    size = float(np.linalg.norm(change.gravity))
    columns = RecordedColumns.of_joints(part.samples.q.shape[1])
    here = _refitted(part, change, columns)
    if here is None or size == 0:
        return float("nan")
    fit, samples = here
    x, slopes = fit.parameters(samples.tau), []
    for direction in np.linalg.svd(change.gravity[None])[2][1:]:
        turned = replace(change, gravity=change.gravity + STEP_OF_SIZE * size * direction)
        there = _refitted(part, turned, columns)
        if there is None:
            return float("nan")
        slopes.append((_residual(there, x) - fit.residual(samples.tau, x)) / STEP_OF_SIZE)
    spread = covariance(fit, fit.residual(samples.tau, x), np.array(slopes))
    return float(np.rad2deg(np.sqrt(np.linalg.eigvalsh(spread)[-1])))


def _refitted(part: Part, change: Change, columns: RecordedColumns) -> tuple[BoundedFit, Samples] | None:
    model, samples, kept = part.after(change, columns)
    fit = fit_of((model, samples, kept))
    return None if fit is None else (fit, samples)


def _residual(found: tuple[BoundedFit, Samples], x: Array) -> Array:
    fit, samples = found
    return fit.residual(samples.tau, x)
