"""The ladder of models of the drives: from viscous and Coulomb friction upwards, as long as folds are predicted better.

Each rung tries every change of one part (drive_models). A change that adds parameters is taken if the error of the
folds falls by more than the standard deviation of this difference; one that removes parameters, if the error does not
rise by more. Of several, the one with the smallest error is taken. The fits are robust and physically consistent
(graphdyn.identification.choosing): least squares lets a few rows at standstill decide.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import NDArray

from crosscheck.identifying.choosing.drive_models import DriveModel, entry_text, every_term
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from crosscheck.recordings.preparation.filtering import filtered_blocks, settling_time
from crosscheck.recordings.preparation.splits import GUARD_TIME, fold_rows
from graphdyn import InvalidInput, RobotModel
from graphdyn.errors import EstimationFailed
from graphdyn.identification import TorqueModel, one_thread
from graphdyn.identification.choosing import FoldedFit, RobustFolds, TermColumns, every_row
from graphdyn.identification.terms import KnownTerm, Term

LADDER_FOLDS = 8
"""Number of folds: enough for a standard deviation, few enough for folds of a second in ten."""

LADDER_ROWS = 800
"""Largest number of rows of each fit: in ten seconds eighty per second, far above the cutoff of the low-pass."""

MIN_FOLD_GUARDS = 2.0
"""Shortest fold, in guards: what is left out around a fold must not be most of the recording."""

MAX_LEAKAGE = 1e-2
"""Fraction of a predicted torque that the filter may still carry into the fit across the guard."""

MIN_GAIN_DEVIATIONS = 1.0
"""Smallest fall of the error that counts, in its standard deviations."""

MIN_RELATIVE_GAIN = 0.01
"""Smallest fall of the error that counts, relative to the error: less is worth no parameters."""

MAX_RUNGS = 10
"""Largest number of changes that are taken."""


@dataclass(frozen=True)
class Step:
    """A change that was tried.

    rung: its number, from 1
    change: as text
    error: held-out error of the model with this change, as a mean over the joints
    difference: this error minus that of the model of the rung
    deviation: standard deviation of the difference
    taken: whether the change was taken
    """

    rung: int
    change: str
    error: float
    difference: float
    deviation: float
    taken: bool


@dataclass(frozen=True, eq=False)
class Ladder:
    """How the terms of the drives were chosen.

    terms: of the chosen model, as in a table of torque models
    start_error: held-out error of the first model, viscous and Coulomb friction, as a mean over the joints
    error: of the chosen model
    steps: every change that was tried, rung by rung
    folds: number of folds; rows: number of rows of each fit
    offsets: whether the model has offsets
    """

    terms: tuple[str, ...]
    start_error: float
    error: float
    steps: tuple[Step, ...]
    folds: int
    rows: int
    offsets: bool
    model: DriveModel

    @property
    def taken(self) -> tuple[Step, ...]:
        """The steps that were taken."""
        return tuple(step for step in self.steps if step.taken)

    @property
    def without_or_with_offsets(self) -> Step:
        """The step of the last rung that removes the offsets, or adds them."""
        change = "without offsets" if self.offsets else "offsets"
        return next(step for step in reversed(self.steps) if step.change == change)


def climbed(
    robot: RobotModel,
    fixed: Sequence[Term],
    known: Sequence[KnownTerm],
    recording: Recording,
    preparation: Preparation,
    *,
    memory: bool = True,
) -> Ladder | str:
    """The ladder on the rows of a differentiated recording, or the reason why there is none.

    fixed: terms that every model has, such as rigid bodies; memory: whether terms may have memory
    """
    try:
        folds = _folds(recording, preparation)
        if isinstance(folds, str):
            return folds
        problem = preparation.problem(TorqueModel(robot, tuple(fixed), tuple(known)), recording)
        every, additions = every_row(len(folds[0][0]), LADDER_ROWS), every_term(memory=memory)
        with one_thread():
            columns = TermColumns.of(problem, additions, every)
            thinned = [(train[::every], test[::every]) for train, test in folds]
            fits = RobustFolds(columns, additions, thinned)
            return _climb(fits.fit, len(folds), len(columns), memory=memory)
    except (EstimationFailed, InvalidInput, np.linalg.LinAlgError) as failure:
        return str(failure)


Fit = Callable[[Sequence[str], FoldedFit | None], FoldedFit]


def _climb(fit: Fit, folds: int, rows: int, *, memory: bool) -> Ladder:
    model, steps = DriveModel(), list[Step]()
    here = fit(model.keys, None)
    start, fits = here.errors.mean, {model: here}
    visited = {model}
    for rung in range(1, MAX_RUNGS + 1):
        tried = []
        for change, other in model.neighbors(memory=memory):
            if other not in fits:
                fits[other] = fit(other.keys, here)
            found = fits[other].errors
            difference = found.minus(here.errors)
            tried.append((change, other, found.mean, *difference))
        good = [one for one in tried if one[1] not in visited and _better(model, *one[1:])]
        best = min(good, key=lambda one: one[2], default=None)
        steps += [Step(rung, change, error, *rest, taken=best is not None and other is best[1])
                  for change, other, error, *rest in tried]
        if best is None:
            break
        model = best[1]
        here = fits[model]
        visited.add(model)
    return Ladder(tuple(map(entry_text, model.entries)), start, here.errors.mean, tuple(steps), folds, rows,
                  bool(model.offsets), model)


def _better(model: DriveModel, other: DriveModel, error: float, difference: float, deviation: float) -> bool:
    """Whether the other model predicts better by more than chance, or has fewer parameters and predicts as well."""
    if other.size < model.size:
        return difference < deviation
    return -difference > max(MIN_GAIN_DEVIATIONS * deviation, MIN_RELATIVE_GAIN * (error - difference))


def _folds(
    recording: Recording, preparation: Preparation
) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]] | str:
    """Rows of each fold's fit and prediction, as those of the equations; or why there are none."""
    guard = max(GUARD_TIME, settling_time(float(recording.torque_cutoff.min()), MAX_LEAKAGE))
    blocks, factor = filtered_blocks(recording, preparation.decimate), prod(preparation.decimate)
    length = sum(float(np.ptp(recording.t[rows])) for rows in blocks)
    if length < LADDER_FOLDS * MIN_FOLD_GUARDS * guard:
        return (
            f"{length:.3g} s are too short for {LADDER_FOLDS} folds with {guard:.2g} s left out around each; record "
            f"{LADDER_FOLDS * MIN_FOLD_GUARDS * guard:.3g} s or more"
        )
    return [
        tuple(np.concatenate([rows[block][::factor] for block in blocks]) for rows in pair)  # type: ignore[misc]
        for pair in fold_rows(recording, LADDER_FOLDS, guard)
    ]
