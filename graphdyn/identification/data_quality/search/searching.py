"""Search for the faults of a recording, which corrects them one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from graphdyn.identification.data_quality.causes.changes import Change, RecordedColumns, changes, scales
from graphdyn.identification.data_quality.causes.sizes import sized_changes
from graphdyn.identification.data_quality.channels.channels import common_rate, rate_gain
from graphdyn.identification.data_quality.channels.measured_torque import Gains
from graphdyn.identification.data_quality.delays.torque_delays import MIN_DELAY, MIN_DELAY_DEVIATIONS
from graphdyn.identification.data_quality.fits.thinning import Piece
from graphdyn.identification.data_quality.search.deciding import (
    MIN_CAD_GAIN,
    MIN_CHANGE_GAIN,
    DataFault,
    decided,
    hints,
    unseen,
)
from graphdyn.identification.data_quality.search.examined import Examined, undone
from graphdyn.identification.data_quality.trials.addition_trials import tried_additions
from graphdyn.identification.data_quality.trials.refining import Curve, curves, refined, tried_gravity
from graphdyn.identification.data_quality.trials.trials import ChangeTrial, trial_of, tried_changes

MAX_DELAY_SHARE = 0.95
"""Part of the searched interval in which a delay must lie: at its ends there is no valley."""

MAX_FAULTS = 3
"""Largest number of faults, each searched after the correction of the previous one."""

MAX_RATE_GAIN_ERROR = 0.2
"""Deviation from 1 of the gain of v on the rate of q beyond which they contradict each other."""


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
    for k, fault in enumerate(best.faults):
        if not fault.instead:
            continue
        is_last = k + 1 == len(best.faults)  # another one in its place may let a further one show
        other, *rest = fault.instead
        known = (*best.faults[:k], replace(other, instead=(replace(fault, instead=()), *rest)))
        corrected = now.after([x.change for x in known if isinstance(x.change, Change)], columns)
        found = _one_by_one(corrected, columns, found_gains, known, at_most=min(len(best.faults) + is_last, MAX_FAULTS))
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
        if contradicting and np.isnan(common_rate(rate_gain(now.pieces))):
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
        if len(faults) < MAX_FAULTS and (fault := decided(part, trials, of_time, before)) is not None:
            faults.append(fault)
            if isinstance(fault.change, Change):
                now = now.after([fault.change], columns)
                continue
        worth = tuple(hints(trials, before)) if len(faults) < MAX_FAULTS else ()
        return Found(tuple(faults), worth, tuple(unseen(trials)), tuple(over_size), now)


def _contradicting(pieces: Sequence[Piece]) -> list[int]:
    """Joints whose v is not the rate of q."""
    return np.flatnonzero(np.abs(rate_gain(pieces) - 1) > MAX_RATE_GAIN_ERROR).tolist()


def _of_positions_or_velocities(
    now: Examined, columns: RecordedColumns, slides: Sequence[bool], contradicting: Sequence[int]
) -> DataFault | None:
    """The change of positions or velocities alone that makes them agree, and the equations fit better."""
    agreeing = []
    for change in changes(slides, contradicting, columns):
        if change.alone:
            left = _contradicting([undone(piece, change, columns) for piece in now.pieces])
            if not set(left) & set(change.joints):
                agreeing.append(change)
    return decided(now.part, [*tried_changes(now.part, columns, agreeing)], [], now.fit.errors(now.samples.tau))


def _most(trials: Sequence[ChangeTrial]) -> float:
    """The gain of the best change."""
    return max((trial.gained for trial in trials), default=0.0)


def _mixes(change: Change, without: Sequence[int]) -> bool:
    """Whether a change of some torques concerns one of these joints."""
    some = change.torque is not None and len(change.joints) < len(change.torque)
    return some and bool(set(change.joints) & set(without))


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
