"""Search for the faults of a recording, which corrects them one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.choices import MANY_SAMPLES
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.data_quality.changes import Change, RecordedColumns, changes, scales
from graphdyn.identification.data_quality.channels import rate_gain
from graphdyn.identification.data_quality.measured_torque import Gains, Lag, gains, lag
from graphdyn.identification.data_quality.thinning import Piece, ThinnedRecording
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

MIN_CHANGE_GAIN = 0.5
"""Fall of Σ log ‖e_j‖ from which a change is a fault: the residual of one joint falls by 40 %, or that of six by 8 %.
On the recordings in docs/industrial_arms.md no wrong change gains more than 0.1, and no fault that is listed there
less than 0.9."""

MIN_LATE_GAIN, MIN_DELAY_DEVIATIONS, MIN_DELAY = 0.15, 4.0, 0.005
"""Bounds for a delay: the fall of Σ log ‖e_j‖, its length in σ, and its length [s]. Friction that
sets in before a joint moves looks like a shorter delay (2.3 ms with the sign of v on the TX40). On those three
recordings delays of at most 6 ms (2.5 σ) gain 0.06 or less, further 20 ms at least 0.28."""

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

MAX_RATE_GAIN_ERROR = 0.2
"""Deviation from 1 of the gain of v on the rate of q beyond which they contradict each other."""


@dataclass(frozen=True, eq=False)
class ChangeTrial:
    """A change that was tried.

    gained: fall of Σ log ‖e_j‖; errors: ‖e_j‖ / ‖τ_j‖ afterwards (n,)
    unexplained: the same relative to the variation of the torque, geometric mean over the joints
    cad_misfit: Σ log of the errors of CAD with fitted drives afterwards, for changes that gain about the same
    """

    change: Change
    gained: float
    errors: Array
    unexplained: float
    cad_misfit: Callable[[], float]

    @property
    def convincing(self) -> bool:
        needed = MIN_LATE_GAIN if self.change.kind == "late torque" else MIN_CHANGE_GAIN
        return self.unexplained < MAX_UNEXPLAINED_SHARE and self.gained >= needed


@dataclass(frozen=True, eq=False)
class DataFault:
    """A fault and the change that corrects it. before, after: ‖e_j‖ / ‖τ_j‖ (n,)

    instead: changes that would be nearly as good
    """

    change: Change
    gained: float
    before: Array
    after: Array
    instead: tuple[Change, ...] = ()


class Examined(NamedTuple):
    """Rows of a recording, their fit and the delay of their torques."""

    thinned: ThinnedRecording
    fit: BoundedFit
    delays: Lag

    @property
    def samples(self) -> Samples:
        return self.thinned.samples


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
        considered = [*changes(slides, contradicting), *scales(found_gains.gain, found_gains.share)]
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
        faults.append(DataFault(best.change, best.gained, before, best.errors, instead))
        pieces = [_undone(piece, best.change, columns) for piece in pieces]
        thinned = ThinnedRecording(pieces)
        fit = BoundedFit.of(torque_model, thinned.samples, best.change.followed(now.fit.kept))
        now = Examined(thinned, fit, lag(thinned, fit))


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
    return ChangeTrial(change, float(np.sum(np.log(before / errors))), errors, unexplained, cad_misfit)


def _late(torque_model: TorqueModel, now: Examined) -> list[ChangeTrial]:
    """The torques of all joints, and of each, with a delay removed."""
    thinned, fit, found = now
    n, before = len(fit.kept.T), fit.errors(thinned.samples.tau)
    trials = []
    for joints, seconds, deviation, gained in [
        (tuple(range(n)), found.common, found.deviation, found.gained),
        *(((j,), found.joints[j], found.deviations[j], found.joints_gained[j]) for j in range(n)),
    ]:
        if not max(MIN_DELAY_DEVIATIONS * deviation, MIN_DELAY) < abs(seconds) < MAX_DELAY_SHARE * thinned.span:
            continue
        lags = np.zeros(n)
        lags[list(joints)] = seconds
        samples = replace(thinned.samples, tau=thinned.torque(lags))
        change = Change("late torque", joints, factor=float(seconds))
        trials.append(replace(_trial(torque_model, change, before, samples, fit), gained=float(gained)))
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
