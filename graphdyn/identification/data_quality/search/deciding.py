"""Which of the changes that were tried is a fault, and which are worth a hint."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from graphdyn.display import short_repr
from graphdyn.identification.data_quality.causes.additions import Addition
from graphdyn.identification.data_quality.causes.changes import Change
from graphdyn.identification.data_quality.fits.held_out import HeldOutGain, held_out_gain, held_out_squares
from graphdyn.identification.data_quality.trials.addition_trials import AdditionTrial
from graphdyn.identification.data_quality.trials.trials import (
    KINDS_THAT_CAD_SHOWS,
    MIN_HINT_GAIN,
    MIN_MISFIT_RISE,
    ChangeTrial,
    Part,
    worth_from,
)
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

MAX_BEHIND_SHARE = 0.25
"""Part of the gain of the best change that another one may lack: of several faults each hides a part of the others."""

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

MAX_UNEXPLAINED_SHARE = 0.5
"""Largest part of the variation of the torques, geometric mean over the joints, that a change may leave: if the
torques are noise, some change always gains."""

MEASURED_SIZE_KINDS = ("late torque", "scaled torque", "gear ratio", "time scale", "gravity", "gravity subtracted")
"""Kinds of changes of a measured size: a small one is no fault, and the smallest visible one is stated."""

DOUBTED_KINDS = ("coupled positions", "coupled joints", "scaled torque")
"""Kinds of changes that need as clear a proof as a size that was found: sums of columns, and a unit, which CAD told."""


@dataclass(frozen=True, eq=False)
@short_repr
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


def decided(
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
    behind = max(MIN_CHANGE_GAIN, MAX_BEHIND_SHARE * first.gained)
    close = [
        (trial, cad)
        for trial, _, squares, cad in shown
        if _about_as_good(held_out_gain(squares, least)) and first.gained - trial.gained < behind
    ]
    best = min(close, key=_doubt)[0]
    if isinstance(best, AdditionTrial):
        added = [trial for trial, _ in close if isinstance(trial, AdditionTrial)]
        return _of_addition(min(added, key=_parameters), before)
    close = sorted((pair for pair in close if isinstance(pair[0], ChangeTrial)), key=_doubt)
    faults = [_of_change(trial, before) for trial, _ in close if isinstance(trial, ChangeTrial)]
    instead = [fault for fault in faults if kind_of(fault.change) != kind_of(best.change)]
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


def kind_of(cause: Change | Addition) -> tuple[str, tuple[int, ...], str]:
    """What makes two causes the same, whatever their sizes are."""
    return cause.kind, cause.joints, cause.alone if isinstance(cause, Change) else ""


def hints(trials: Sequence[ChangeTrial], before: Array) -> Iterator[DataFault]:
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


def unseen(trials: Sequence[ChangeTrial]) -> Iterator[Change]:
    """Changes that the recording cannot reveal."""
    for trial in trials:
        if -MIN_MISFIT_RISE < trial.gained < MIN_CHANGE_GAIN and trial.change.kind not in MEASURED_SIZE_KINDS:
            yield trial.change
