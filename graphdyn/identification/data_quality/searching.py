"""Search for the faults of a recording, which corrects them one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.least_squares import one_thread
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.causes.additions import Addition
from graphdyn.identification.data_quality.causes.changes import Change, RecordedColumns, changes, scales
from graphdyn.identification.data_quality.causes.sizes import sized_changes
from graphdyn.identification.data_quality.channels.channels import rate_gain
from graphdyn.identification.data_quality.channels.measured_torque import Gains
from graphdyn.identification.data_quality.delays.torque_delays import MIN_DELAY, MIN_DELAY_DEVIATIONS, Lag, lag
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.identification.data_quality.fits.held_out import HeldOutGain, held_out_gain, held_out_squares
from graphdyn.identification.data_quality.fits.thinning import Piece, ThinnedRecording
from graphdyn.identification.data_quality.trials.addition_trials import AdditionTrial, tried_additions
from graphdyn.identification.data_quality.trials.refining import (
    Curve,
    curves,
    refined,
    tried_gravity,
)
from graphdyn.identification.data_quality.trials.trials import (
    KINDS_THAT_CAD_SHOWS,
    MIN_HINT_GAIN,
    MIN_MISFIT_RISE,
    ChangeTrial,
    Part,
    trial_of,
    tried_changes,
    worth_from,
)
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

MIN_CHANGE_GAIN = 0.5
"""Fall of Σ log ‖e_j‖ from which a change is a fault: the residual of one joint falls by 40 %, or that of six by 8 %.
On the recordings in docs/industrial_arms.md no wrong change gains more than 0.15, and no fault that is listed there
less than 0.9."""

MIN_HELD_OUT_DEVIATIONS = 3.0
"""Gain over blocks that were not fitted, in its standard deviations, from which a size that was found is a fault. On
the KR300, whose load does not change, a load that is taken off gains 0.6, and there -1.9 ± 1.2."""

MAX_BEHIND_DEVIATIONS = 2.0
"""Gain of the best change over another one, in its standard deviations, up to which CAD decides between them; and of
further columns, from which CAD confirms them."""

MIN_CAD_GAIN = 1.0
"""Fall of the criterion of CAD with fitted drives that confirms a size if the blocks disagree about it, and shows that
gravity was subtracted. On three arms it falls by 1.6 to 9.9 where it was, even from the best common unit, and rises by
4.7 or more where it was not."""

MAX_CAD_LOSS = 2.0
"""Rise of the criterion of CAD, in gains of a change, beyond which CAD contradicts it."""

MAX_HELD_OUT = 8
"""Largest number of changes whose gain over blocks that were not fitted is computed, those that gain most."""

MIN_HINT_DEVIATIONS = 3.0
"""Distance of a size from no change, in standard deviations, from which there is a hint."""

MIN_LATE_GAIN = 0.15
"""Fall of Σ log ‖e_j‖ from which a delay of all torques is a fault. On those three recordings delays of at most 7 ms
(2.5 σ) gain 0.07 or less, further 20 ms at least 0.28."""

MAX_DELAY_SHARE = 0.95
"""Part of the searched interval in which a delay must lie: at its ends there is no valley."""

MAX_UNEXPLAINED_SHARE = 0.5
"""Largest part of the variation of the torques, geometric mean over the joints, that a change may leave: if the
torques are noise, some change always gains."""

MEASURED_SIZE_KINDS = ("late torque", "scaled torque", "gear ratio", "time scale", "gravity", "gravity subtracted")
"""Kinds of changes of a measured size: a small one is no fault, and the smallest visible one is stated."""

DOUBTED_KINDS = ("coupled positions", "coupled joints", "scaled torque")
"""Kinds of changes that need as clear a proof as a size that was found: sums of columns, and a unit, which CAD told."""

MAX_FAULTS = 3
"""Largest number of faults, each searched after the correction of the previous one."""

MIN_KEPT_SHARE = 0.05
"""Part of the rows of a joint that must be faster than the smallest speed; otherwise all of them count: it may be the
unit of the angles that makes it slow."""

MAX_CLOCK_SPREAD = 0.01
"""Relative difference between the gains of v on the rates of q up to which they are one, that of a clock."""

MAX_RATE_GAIN_ERROR = 0.2
"""Deviation from 1 of the gain of v on the rate of q beyond which they contradict each other."""


@dataclass(frozen=True, eq=False)
class DataFault:
    """A fault, and the change that corrects it or the addition that explains it. before, after: ‖e_j‖ / ‖τ_j‖ (n,)

    instead: faults that would be nearly as good
    deviation: standard deviation of a size that was found; NaN for another fault
    parameters: those of the columns of an addition         (c,)
    """

    change: Change | Addition
    gained: float
    before: Array
    after: Array
    instead: tuple[DataFault, ...] = ()
    deviation: float = float("nan")
    parameters: Array | None = None


@dataclass(frozen=True, eq=False)
class Examined:
    """A recording, as it is or after changes.

    min_speed: of the rows that count for a joint, (n,) or one for all
    without: joints whose torque does not count
    fit, delays: of the thinned rows
    """

    torque_model: TorqueModel
    pieces: Sequence[Piece]
    min_speed: ArrayLike
    without: tuple[int, ...]
    thinned: ThinnedRecording
    fit: BoundedFit
    delays: Lag

    @classmethod
    def of(
        cls,
        torque_model: TorqueModel,
        pieces: Sequence[Piece],
        min_speed: ArrayLike,
        without: tuple[int, ...] = (),
    ) -> Examined:
        """The recording of these pieces. min_speed: as in Problem"""
        thinned = ThinnedRecording(pieces)
        kept = np.abs(thinned.samples.v) >= min_speed
        resting = kept.mean(axis=0) < MIN_KEPT_SHARE
        counted = (kept | resting) & ~np.isin(np.arange(kept.shape[1]), without)
        fit = BoundedFit.of(torque_model, thinned.samples, counted)
        return cls(torque_model, pieces, min_speed, without, thinned, fit, lag(torque_model, thinned, fit))

    @property
    def samples(self) -> Samples:
        return self.thinned.samples

    @cached_property
    def part(self) -> Part:
        rate = self.thinned.torque_rate(np.zeros(self.samples.tau.shape[1]))
        return Part(self.torque_model, self.samples, self.fit, rate)

    def with_derived_velocities(self) -> Examined:
        """The recording with velocities and accelerations from its positions."""
        pieces = [piece.derived() for piece in self.pieces]
        return Examined.of(self.torque_model, pieces, self.min_speed, self.without)

    def after(self, changes: Sequence[Change], columns: RecordedColumns) -> Examined:
        """The recording after some changes, one after the other."""
        if not changes:
            return self
        model, pieces = self.torque_model, self.pieces
        for change in changes:
            model, pieces = change.under_gravity(model), [_undone(piece, change, columns) for piece in pieces]
        return Examined.of(model, pieces, self.min_speed, self.without)


class FoundGravity(NamedTuple):
    """Gravity that explains a recording best.

    gravity: in world axes                                  (3,) [m/s²]
    deviation: standard deviation of its direction          [°]
    before, after: ‖e_j‖ / ‖τ_j‖ under the gravity of the model, and under this one   (n,)
    """

    gravity: Array
    deviation: float
    before: Array
    after: Array


def found_gravity(torque_model: TorqueModel, pieces: Sequence[Piece], min_speed: ArrayLike = 0.0) -> FoundGravity:
    """Direction of gravity, and its size where that fits clearly better, with plausible inertial parameters.

    The arguments are those of assess_recording. Raises InvalidInput if no direction fits, and as assess_recording.
    """
    with one_thread():
        now = Examined.of(torque_model, pieces, min_speed)
        trials = [trial for trial in tried_gravity(now.part, -np.inf) if trial.deviation_of_size is not None]
        if not trials:
            raise InvalidInput("the torques of the recording fit no gravity; give it by --gravity X Y Z, or gravity=")
        most = max(trial.gained for trial in trials)
        best = min((t for t in trials if t.gained > most - MIN_MISFIT_RISE), key=lambda trial: trial.cad_misfit())
        assert best.change.gravity is not None
        return FoundGravity(best.change.gravity, best.deviation, now.fit.errors(now.samples.tau), best.errors)


class Found(NamedTuple):
    """Result of the search.

    faults: in the order of their correction; hints: what would gain a little in the corrected recording
    unseen: changes that the corrected recording cannot reveal
    curves: its criterion over sizes that are to be found; left: the corrected recording
    """

    faults: tuple[DataFault, ...]
    hints: tuple[DataFault, ...]
    unseen: tuple[Change, ...]
    curves: tuple[Curve, ...]
    left: Examined


def search(now: Examined, columns: RecordedColumns, found_gains: Gains) -> Found:
    """The faults of a recording, each searched after the correction of the previous ones.

    Of several faults one may be taken for another that explains nearly as much, until the others are corrected. The one
    after which CAD fits next best is corrected in its place, too, and the faults that explain more are taken.
    """
    best = _one_by_one(now, columns, found_gains, ())
    for k, fault in enumerate(best.faults[:-1]):
        if not fault.instead:
            continue
        other, *rest = fault.instead
        known = (*best.faults[:k], replace(other, instead=(replace(fault, instead=()), *rest)))
        corrected = now.after([x.change for x in known if isinstance(x.change, Change)], columns)
        found = _one_by_one(corrected, columns, found_gains, known, at_most=len(best.faults))
        if _explains_more(found, best):
            return _one_by_one(found.left, columns, found_gains, found.faults)
    return best


def _explains_more(found: Found, other: Found) -> bool:
    """Whether faults explain a recording better than others: by what is left, then by the fit of CAD."""
    more = other.left.part.misfit - found.left.part.misfit
    if abs(more) > MIN_CHANGE_GAIN:
        return more > 0
    of_cad = other.left.part.cad_misfit - found.left.part.cad_misfit
    return len(found.faults) <= len(other.faults) and of_cad > MIN_CAD_GAIN


def _one_by_one(
    now: Examined, columns: RecordedColumns, found_gains: Gains, known: Sequence[DataFault], at_most: int = 0
) -> Found:
    """The faults of a recording from which the known ones were removed, one after the other, behind these.

    at_most: number of faults after which what is left is not searched for hints; 0 for MAX_FAULTS and hints
    """
    model = now.torque_model.model
    slides = [model.joints[k].is_prismatic for k in model.degrees_of_freedom.independent]
    faults = list(known)
    while True:
        if 0 < at_most <= len(faults):
            return Found(tuple(faults), (), (), (), now)
        contradicting = _contradicting(now.pieces)
        if contradicting and not _is_clock(now.pieces):
            fault = _of_positions_or_velocities(now, columns, slides, contradicting)
            if fault is None or not isinstance(fault.change, Change) or len(faults) == MAX_FAULTS:
                now = now.with_derived_velocities()
            else:
                faults.append(fault)
                now = now.after([fault.change], columns)
            continue
        before = now.fit.errors(now.samples.tau)
        considered = [*changes(slides, contradicting, columns), *scales(found_gains.gain, found_gains.share)]
        part = now.part
        sized = [*sized_changes(slides, contradicting, not contradicting)]
        if now.without:  # a torque that does not count tells nothing of those that are mixed with it
            considered = [change for change in considered if not _mixes(change, now.without)]
            sized = [change for change in sized if not _mixes(change.of(change.tried[0]), now.without)]
        over_size = curves(part, columns, sized)
        trials = [*tried_changes(part, columns, considered)]
        trials += [
            *refined(part, columns, over_size, _most(trials)),
            *([] if any(fault.change.kind == "gravity subtracted" for fault in faults) else tried_gravity(part)),
            *_late(now),
        ]
        of_time = [*tried_additions(part, _most(trials))]
        if len(faults) < MAX_FAULTS and (fault := _decided(part, trials, of_time, before)) is not None:
            faults.append(fault)
            if isinstance(fault.change, Change):
                now = now.after([fault.change], columns)
                continue
        hints = tuple(_hints(trials, before)) if len(faults) < MAX_FAULTS else ()
        return Found(tuple(faults), hints, tuple(_unseen(trials)), tuple(over_size), now)


def _contradicting(pieces: Sequence[Piece]) -> list[int]:
    """Joints whose v is not the rate of q."""
    return np.flatnonzero(np.abs(rate_gain(pieces) - 1) > MAX_RATE_GAIN_ERROR).tolist()


def _is_clock(pieces: Sequence[Piece]) -> bool:
    """Whether all velocities are the same multiple of the rates, as with a wrong clock."""
    rates = rate_gain(pieces)
    known = rates[np.isfinite(rates)]
    return len(known) > 1 and bool(np.ptp(known) < MAX_CLOCK_SPREAD * abs(np.median(known)))


def _of_positions_or_velocities(
    now: Examined, columns: RecordedColumns, slides: Sequence[bool], contradicting: Sequence[int]
) -> DataFault | None:
    """The change of positions or velocities alone that makes them agree, and the equations fit better."""
    agreeing = []
    for change in changes(slides, contradicting, columns):
        if change.alone:
            left = _contradicting([_undone(piece, change, columns) for piece in now.pieces])
            if not set(left) & set(change.joints):
                agreeing.append(change)
    return _decided(now.part, [*tried_changes(now.part, columns, agreeing)], [], now.fit.errors(now.samples.tau))


def _most(trials: Sequence[ChangeTrial]) -> float:
    """The gain of the best change."""
    return max((trial.gained for trial in trials), default=0.0)


def _mixes(change: Change, without: Sequence[int]) -> bool:
    """Whether a change of some torques concerns one of these joints."""
    some = change.torque is not None and len(change.joints) < len(change.torque)
    return some and bool(set(change.joints) & set(without))


def _decided(
    part: Part, trials: Sequence[ChangeTrial], of_time: Sequence[AdditionTrial], before: Array
) -> DataFault | None:
    """The fault that blocks which were not fitted show most clearly; None if there is no fault.

    Among those that gain about as much there, it is the one after which CAD fits best.
    """
    convincing: list[ChangeTrial | AdditionTrial] = [trial for trial in trials if _convinces(trial, part)]
    convincing += [trial for trial in of_time if trial.gained >= MIN_CHANGE_GAIN]
    if not convincing:
        return None
    worth = worth_from(max(trial.gained for trial in convincing))
    convincing = [trial for trial in convincing if trial.gained > worth or _by_cad(trial)]
    convincing = sorted(convincing, key=lambda trial: -trial.gained)[:MAX_HELD_OUT]
    unchanged, of_cad = held_out_squares(part.fit, part.samples.tau), part.cad_misfit
    shown: list[tuple[ChangeTrial | AdditionTrial, float, Array, float]] = []
    for trial in convincing:
        squares, cad = trial.held_out(), trial.cad_misfit()
        there = held_out_gain(unchanged, squares)
        if _holds(trial, there, of_cad - cad):
            shown.append((trial, there.gained, squares, cad))
    proven = min((cad for trial, _, _, cad in shown if _by_cad(trial)), default=np.inf)  # explains a gravity, too
    shown = [found for found in shown if not (_is_gravity(found[0]) and found[3] > proven - MIN_CAD_GAIN)]
    if not shown:
        return None
    first, _, least, _ = max(shown, key=lambda found: np.inf if _by_cad(found[0]) else found[1])
    close = [
        (trial, cad)
        for trial, _, squares, cad in shown
        if _about_as_good(held_out_gain(squares, least)) and first.gained - trial.gained < MIN_CHANGE_GAIN
    ]
    best = min(close, key=_doubt)[0]
    if isinstance(best, AdditionTrial):
        added = [trial for trial, _ in close if isinstance(trial, AdditionTrial)]
        return _of_addition(min(added, key=_parameters), before)
    close = sorted((pair for pair in close if isinstance(pair[0], ChangeTrial)), key=_doubt)
    faults = [_of_change(trial, before) for trial, _ in close if isinstance(trial, ChangeTrial)]
    instead = [fault for fault in faults if not _alike(fault.change, best.change)]
    return replace(_of_change(best, before), instead=tuple(instead))


def _of_change(trial: ChangeTrial, before: Array) -> DataFault:
    return DataFault(trial.change, trial.gained, before, trial.errors, deviation=trial.deviation)


def _doubt(found: tuple[ChangeTrial | AdditionTrial, float]) -> float:
    """Criterion of CAD afterwards; what changed in between needs more than a change of the whole recording."""
    trial, of_cad = found
    return of_cad + (MIN_CAD_GAIN if isinstance(trial, AdditionTrial) else 0.0)


def _by_cad(trial: ChangeTrial | AdditionTrial) -> bool:
    """Whether CAD alone shows a change."""
    return isinstance(trial, ChangeTrial) and trial.change.kind in KINDS_THAT_CAD_SHOWS


def _is_gravity(trial: ChangeTrial | AdditionTrial) -> bool:
    return isinstance(trial, ChangeTrial) and trial.change.kind == "gravity"


def _about_as_good(behind: HeldOutGain) -> bool:
    """Whether a change is about as good as the best one. behind: gain of the best one over it"""
    return behind.gained < max(MIN_MISFIT_RISE, MAX_BEHIND_DEVIATIONS * behind.deviation)


def _of_addition(trial: AdditionTrial, before: Array) -> DataFault:
    x, deviation = trial.parameters, trial.deviation_of_size()
    return DataFault(trial.addition, trial.gained, before, trial.errors, deviation=deviation, parameters=x)


def _parameters(trial: AdditionTrial) -> tuple[int, int, float]:
    """Order of additions that explain a recording about as well: those with few parameters, of few joints, first."""
    return trial.addition.columns.shape[-1], len(trial.addition.joints), -trial.gained


def _convinces(trial: ChangeTrial, part: Part) -> bool:
    """Whether a change gains enough for a fault, or CAD proves it."""
    if _by_cad(trial):
        return part.scaled_cad_misfit - trial.cad_misfit() > MIN_CAD_GAIN
    all_late = trial.change.kind == "late torque" and len(trial.change.joints) == len(trial.errors)
    needed = MIN_LATE_GAIN if all_late else MIN_CHANGE_GAIN
    return trial.unexplained < MAX_UNEXPLAINED_SHARE and trial.gained >= needed


def _holds(trial: ChangeTrial | AdditionTrial, there: HeldOutGain, of_cad: float) -> bool:
    """Whether blocks that were not fitted confirm a change; a size, or a doubted kind, clearly or by CAD.

    of_cad: fall of the criterion of CAD with fitted drives
    """
    if isinstance(trial, ChangeTrial):
        if trial.change.kind == "late torque" or _by_cad(trial):  # proven where they are found
            return True
        if of_cad < -MAX_CAD_LOSS * trial.gained:
            return False
        if trial.deviation_of_size is None and trial.change.kind not in DOUBTED_KINDS:
            return there.gained > 0
    clear = there.gained > MIN_HELD_OUT_DEVIATIONS * there.deviation
    if isinstance(trial, AdditionTrial) and not there.gained > MAX_BEHIND_DEVIATIONS * there.deviation:
        return False  # CAD fits better with any further columns
    return there.gained > MIN_HINT_GAIN and (clear or of_cad > MIN_CAD_GAIN)


def _alike(one: Change | Addition, other: Change | Addition) -> bool:
    """Whether two changes differ in their size alone."""
    alone = [getattr(change, "alone", "") for change in (one, other)]
    return (one.kind, one.joints, alone[0]) == (other.kind, other.joints, alone[1])


def _hints(trials: Sequence[ChangeTrial], before: Array) -> Iterator[DataFault]:
    """The change of an unknown size that gains most, if it is clearly none."""
    sized = [trial for trial in trials if trial.gained > MIN_HINT_GAIN and trial.deviation_of_size is not None]
    clear = [trial for trial in sized if _size(trial.change) > MIN_HINT_DEVIATIONS * trial.deviation]
    if clear:
        best = max(clear, key=lambda trial: trial.gained)
        yield DataFault(best.change, best.gained, before, best.errors, deviation=best.deviation)


def _size(change: Change) -> float:
    """Distance of a size that was found from no change."""
    if change.kind == "zero" and change.zero is not None:
        return float(np.rad2deg(np.abs(change.zero).max()))
    return abs(change.factor - 1)


def _unseen(trials: Sequence[ChangeTrial]) -> Iterator[Change]:
    for trial in trials:
        if -MIN_MISFIT_RISE < trial.gained < MIN_CHANGE_GAIN and trial.change.kind not in MEASURED_SIZE_KINDS:
            yield trial.change


def _late(now: Examined) -> Iterator[ChangeTrial]:
    """The torques of all joints, and of each, with a delay removed."""
    thinned, fit, found = now.thinned, now.fit, now.delays
    n, before = len(fit.kept.T), fit.errors(thinned.samples.tau)
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
        own = trial_of(now.torque_model, change, before, samples, fit)
        yield replace(own, gained=float(gained), deviation_of_size=partial(float, deviation))


def _undone(piece: Piece, change: Change, columns: RecordedColumns) -> Piece:
    if change.kind == "late torque":
        n = len(columns.zero)
        seconds = np.zeros(n)
        seconds[list(change.joints)] = change.factor
        return piece.later(seconds)
    period = piece.period * change.factor if change.kind == "time scale" else piece.period
    return replace(piece, samples=change.applied(piece.samples, columns), period=period)
