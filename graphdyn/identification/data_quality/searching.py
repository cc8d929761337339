"""Search for the faults of a recording, which corrects them one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.choices import MANY_SAMPLES
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.data_quality.changes import Change, RecordedColumns, changes, scales
from graphdyn.identification.data_quality.channels import rate_gain
from graphdyn.identification.data_quality.measured_torque import Gains, gains
from graphdyn.identification.data_quality.thinning import Piece, ThinnedRecording
from graphdyn.identification.data_quality.torque_delays import MIN_DELAY, MIN_DELAY_DEVIATIONS, Lag, lag
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

MIN_CHANGE_GAIN = 0.5
"""Fall of Σ log ‖e_j‖ from which a change is a fault: the residual of one joint falls by 40 %, or that of six by 8 %.
On the recordings in docs/industrial_arms.md no wrong change gains more than 0.1, and no fault that is listed there
less than 0.9."""

MIN_LATE_GAIN = 0.15
"""Fall of Σ log ‖e_j‖ from which a delay of all torques is a fault. On those three recordings delays of at most 7 ms
(2.5 σ) gain 0.07 or less, further 20 ms at least 0.28."""

MAX_DELAY_SHARE = 0.95
"""Part of the searched interval in which a delay must lie: at its ends there is no valley."""

MAX_UNEXPLAINED_SHARE = 0.5
"""Largest part of the variation of the torques, geometric mean over the joints, that a change may leave: if the
torques are noise, some change always gains."""

MIN_MISFIT_RISE = 0.25
"""Rise of Σ log ‖e_j‖ below which a recording cannot reveal that a change would be wrong."""

MEASURED_SIZE_KINDS = ("late torque", "scaled torque")
"""Kinds of changes of a measured size: a small one is no fault, and the gains show a large one."""

MAX_FAULTS = 3
"""Largest number of faults, each searched after the correction of the previous one."""

MIN_KEPT_SHARE = 0.05
"""Part of the rows of a joint that must be faster than the smallest speed; otherwise all of them count: it may be the
unit of the angles that makes it slow."""

MAX_RATE_GAIN_ERROR = 0.2
"""Deviation from 1 of the gain of v on the rate of q beyond which they contradict each other."""


@dataclass(frozen=True, eq=False)
class ChangeTrial:
    """A change that was tried.

    gained: fall of Σ log ‖e_j‖; errors: ‖e_j‖ / ‖τ_j‖ afterwards (n,)
    unexplained: the same relative to the variation of the torque, geometric mean over the joints
    cad_misfit: Σ log of the errors of CAD with fitted drives afterwards, for changes that gain about the same
    deviation: standard deviation of a size that was found, in its unit; NaN for another change
    """

    change: Change
    gained: float
    errors: Array
    unexplained: float
    cad_misfit: Callable[[], float]
    deviation: float = float("nan")

    @property
    def convincing(self) -> bool:
        all_late = self.change.kind == "late torque" and len(self.change.joints) == len(self.errors)
        needed = MIN_LATE_GAIN if all_late else MIN_CHANGE_GAIN
        return self.unexplained < MAX_UNEXPLAINED_SHARE and self.gained >= needed


@dataclass(frozen=True, eq=False)
class DataFault:
    """A fault and the change that corrects it. before, after: ‖e_j‖ / ‖τ_j‖ (n,)

    instead: changes that would be nearly as good
    deviation: standard deviation of a size that was found; NaN for another fault
    """

    change: Change
    gained: float
    before: Array
    after: Array
    instead: tuple[Change, ...] = ()
    deviation: float = float("nan")


class Examined(NamedTuple):
    """Rows of a recording, their fit and the delay of their torques."""

    thinned: ThinnedRecording
    fit: BoundedFit
    delays: Lag

    @property
    def samples(self) -> Samples:
        return self.thinned.samples


def examined(torque_model: TorqueModel, pieces: Sequence[Piece], min_speed: ArrayLike) -> Examined:
    """Pieces as they are. min_speed: as in Problem"""
    thinned = ThinnedRecording(pieces)
    v = np.abs(thinned.samples.v)
    kept = v >= min_speed
    resting = kept.mean(axis=0) < MIN_KEPT_SHARE
    fit = BoundedFit.of(torque_model, thinned.samples, kept | resting)
    return Examined(thinned, fit, lag(torque_model, thinned, fit))


def search(
    torque_model: TorqueModel, pieces: Sequence[Piece], columns: RecordedColumns, now: Examined, found_gains: Gains
) -> tuple[tuple[DataFault, ...], tuple[Change, ...], Examined]:
    """The faults, the changes that the corrected recording cannot reveal, and this recording.

    now: the recording as it is
    """
    model = torque_model.model
    slides = [model.joints[k].is_prismatic for k in model.degrees_of_freedom.independent]
    faults: list[DataFault] = []
    while True:
        before = now.fit.errors(now.samples.tau)
        contradicting = np.flatnonzero(np.abs(rate_gain(pieces) - 1) > MAX_RATE_GAIN_ERROR).tolist()
        considered = [*changes(slides, contradicting, columns), *scales(found_gains.gain, found_gains.share)]
        trials = [*_tried(torque_model, now, columns, considered), *_late(torque_model, now)]
        found = [trial for trial in trials if trial.convincing]
        if not found or len(faults) == MAX_FAULTS:
            unseen = [
                t.change
                for t in trials
                if -MIN_MISFIT_RISE < t.gained < MIN_CHANGE_GAIN and t.change.kind not in MEASURED_SIZE_KINDS
            ]
            return tuple(faults), tuple(unseen), now
        largest = max(trial.gained for trial in found)
        close = [trial for trial in found if trial.gained > largest - MIN_MISFIT_RISE]
        best = min(close, key=lambda trial: trial.cad_misfit()) if len(close) > 1 else close[0]
        instead = tuple(trial.change for trial in close if trial is not best)
        faults.append(DataFault(best.change, best.gained, before, best.errors, instead, best.deviation))
        pieces, now = _corrected(torque_model, pieces, now, best.change, columns)


def corrected(
    torque_model: TorqueModel, pieces: Sequence[Piece], columns: RecordedColumns, now: Examined, some: Sequence[Change]
) -> Examined:
    """A recording after some changes, one after the other."""
    for change in some:
        pieces, now = _corrected(torque_model, pieces, now, change, columns)
    return now


def _corrected(
    torque_model: TorqueModel, pieces: Sequence[Piece], now: Examined, change: Change, columns: RecordedColumns
) -> tuple[Sequence[Piece], Examined]:
    pieces = [_undone(piece, change, columns) for piece in pieces]
    thinned = ThinnedRecording(pieces)
    fit = BoundedFit.of(torque_model, thinned.samples, change.followed(now.fit.kept))
    return pieces, Examined(thinned, fit, lag(torque_model, thinned, fit))


def _tried(
    torque_model: TorqueModel, now: Examined, columns: RecordedColumns, considered: Sequence[Change]
) -> Iterator[ChangeTrial]:
    samples, fit = now.samples, now.fit
    before = fit.errors(samples.tau)
    for change in considered:
        if not change.moves:
            yield _trial(torque_model, change, before, change.applied(samples, columns), fit)
    moving, size = [change for change in considered if change.moves], -(-MANY_SAMPLES // len(samples))
    for start in range(0, len(moving), size):
        some = moving[start : start + size]
        motions = [change.applied(samples, columns) for change in some]
        kept = [change.followed(fit.kept) for change in some]
        for change, motion, other in zip(some, motions, _fits(torque_model, motions, kept), strict=True):
            if other is not None:
                yield _trial(torque_model, change, before, motion, other)


def _fits(
    torque_model: TorqueModel, motions: Sequence[Samples], kept: Sequence[NDArray[np.bool_]]
) -> list[BoundedFit | None]:
    """The fits of changed motions; None for an impossible motion, which a user's term or torque refuses."""
    try:
        return [*BoundedFit.several(torque_model, motions, kept)]
    except Exception:
        if len(motions) == 1:
            return [None]
        return [_fits(torque_model, [motion], [rows])[0] for motion, rows in zip(motions, kept, strict=True)]


def _trial(torque_model: TorqueModel, change: Change, before: Array, samples: Samples, fit: BoundedFit) -> ChangeTrial:
    errors = fit.errors(samples.tau)

    def cad_misfit() -> float:
        return float(np.nansum(np.log(np.maximum(gains(torque_model, samples, fit).without_gain, MIN_RESIDUAL))))

    varies = variation(samples.tau)
    unexplained = float(np.exp(np.mean(np.log(errors / np.where(varies > 0, varies, 1.0)))))
    trial = ChangeTrial(change, float(np.sum(np.log(before / errors))), errors, unexplained, cad_misfit)
    return trial if trial.convincing else replace(trial, cad_misfit=_not_compared)


def _not_compared() -> float:
    """A stand-in for the misfit of a change that nobody asks for: that would keep the equations of its motion, 2 MB."""
    return np.inf


def _late(torque_model: TorqueModel, now: Examined) -> list[ChangeTrial]:
    """The torques of all joints, and of each, with a delay removed."""
    thinned, fit, found = now
    n, before = len(fit.kept.T), fit.errors(thinned.samples.tau)
    trials = []
    for joints, seconds, deviation, gained, held_out in [
        (tuple(range(n)), found.common, found.deviation, found.gained, found.held_out),
        *(
            ((j,), found.joints[j], found.deviations[j], found.joints_gained[j], found.joints_held_out[j])
            for j in range(n)
        ),
    ]:
        if not max(MIN_DELAY_DEVIATIONS * deviation, MIN_DELAY) < abs(seconds) < MAX_DELAY_SHARE * thinned.span:
            continue
        if not held_out.improves:
            continue
        lags = np.zeros(n)
        lags[list(joints)] = seconds
        samples = replace(thinned.samples, tau=thinned.torque(lags))
        change = Change("late torque", joints, factor=float(seconds))
        trial = _trial(torque_model, change, before, samples, fit)
        trials.append(replace(trial, gained=float(gained), deviation=float(deviation)))
    return trials


def _undone(piece: Piece, change: Change, columns: RecordedColumns) -> Piece:
    if change.kind == "late torque":
        n = len(columns.zero)
        seconds = np.zeros(n)
        seconds[list(change.joints)] = change.factor
        return piece.later(seconds)
    return replace(piece, samples=change.applied(piece.samples, columns))


def variation(tau: Array) -> Array:
    """Variation ‖τ_j - mean‖ / ‖τ_j‖ (n,)."""
    size = np.linalg.norm(tau, axis=0)
    return np.asarray(np.linalg.norm(tau - tau.mean(axis=0), axis=0) / np.where(size > 0, size, 1.0))
