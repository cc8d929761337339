"""The ladder of models of the drives: from viscous and Coulomb friction upwards, as long as folds are predicted better.

Each rung tries every change of one part (drive_models). A change is taken if the error of the folds falls by more than
the standard deviation of this difference; one that leaves a part out, if the error does not rise by more. Of several,
the one with the smallest error is taken. Where no single change helps, all parts together are tried, from which those
that are not needed are left out again. The fits are robust and physically consistent
(graphdyn.identification.choosing): least squares lets a few rows at standstill decide.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.identifying.choosing.drive_models import (
    FULL,
    DriveModel,
    ModelChange,
    entry_text,
    every_term,
    parts_without_use,
)
from crosscheck.identifying.choosing.folds import beginning, choosing_folds
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from graphdyn import InvalidInput, RobotModel
from graphdyn.errors import EstimationFailed
from graphdyn.identification import TorqueModel, one_thread
from graphdyn.identification.choosing import FoldedFit, RobustFolds, TermColumns, every_row
from graphdyn.identification.terms import KnownTerm, Term, Viscous

LADDER_ROWS = 800
"""Largest number of rows of each fit: in ten seconds eighty per second, far above the cutoff of the low-pass."""

MIN_GAIN_DEVIATIONS = 1.0
"""Smallest fall of the error that counts, in its standard deviations."""

MIN_RELATIVE_GAIN = 0.01
"""Smallest fall of the error that counts, relative to the error: less is worth no parameters."""

STANDARD = DriveModel(offsets="offsets")
"""The model where no ladder can be climbed."""

MIN_COUPLING_GAIN = 0.1
"""The same for a coupled wrist: where it is, it halves the error; where it is not, it has imitated other lacks of a
model and gained 5 %."""

ALL_PARTS = "all parts but memory and coupling"
"""The change that is tried where no single one helps, as text."""

MAX_RUNGS = 10
"""Largest number of changes that are taken."""


@dataclass(frozen=True)
class LadderStep:
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
    start_error: held-out error of the first model, viscous and Coulomb friction, as a mean over the joints; NaN
        without a ladder
    error: of the chosen model; NaN without a ladder
    steps: every change that was tried, rung by rung
    folds: number of folds; rows: number of rows of each fit
    of_rows: number of rows of the recording, from its beginning, of which these are every so many
    correlation_times: length of the rows in correlation times of the residual, for the joint with the longest one;
        infinite for white residuals; NaN without a ladder
    model: the chosen one
    reason: why no ladder could be climbed, so that the model is the standard one; empty if it was
    """

    terms: tuple[str, ...]
    start_error: float
    error: float
    steps: tuple[LadderStep, ...]
    folds: int
    rows: int
    of_rows: int
    correlation_times: float
    model: DriveModel
    reason: str = ""

    @classmethod
    def of_standard_terms(cls, reason: str) -> Ladder:
        """Viscous and Coulomb friction and offsets, without a ladder."""
        nothing = float("nan")
        return cls(tuple(map(entry_text, STANDARD.entries)), nothing, nothing, (), 0, 0, 0, nothing, STANDARD, reason)

    @property
    def taken(self) -> tuple[LadderStep, ...]:
        """The steps that were taken."""
        return tuple(step for step in self.steps if step.taken)

    @property
    def offsets(self) -> LadderStep | None:
        """The step of the last rung that removes the offsets, or adds them; None without a ladder."""
        change = "without offsets" if self.model.offsets else "offsets"
        return next((step for step in reversed(self.steps) if step.change == change), None)


def climbed(
    robot: RobotModel,
    fixed: Sequence[Term],
    known: Sequence[KnownTerm],
    recording: Recording,
    preparation: Preparation,
    *,
    memory: bool = True,
) -> Ladder:
    """The ladder on the rows of a recording; standard terms, with the reason, where it cannot be climbed.

    recording: differentiated
    fixed: terms that every model has, such as rigid bodies; memory: whether terms may have memory
    """
    try:
        recording = beginning(recording)
        folds = choosing_folds(recording, preparation)
        if isinstance(folds, str):
            return Ladder.of_standard_terms(folds)
        problem = preparation.problem(TorqueModel(robot, (*fixed, Viscous()), tuple(known)), recording)
        every, without = every_row(len(folds[0][0]), LADDER_ROWS), parts_without_use(robot, fixed, memory=memory)
        additions = every_term(without)
        with one_thread():
            columns = TermColumns.of(problem, additions, every)
            thinned = [(train[::every], test[::every]) for train, test in folds]
            fits = RobustFolds(columns, additions, thinned)
            return replace(_climb(fits.fit, len(folds), without), of_rows=len(folds[0][0]))
    except (EstimationFailed, InvalidInput, np.linalg.LinAlgError) as failure:
        return Ladder.of_standard_terms(str(failure))


Fit = Callable[[Sequence[str], FoldedFit | None], FoldedFit]


def _climb(fit: Fit, folds: int, without: Collection[str]) -> Ladder:
    model, steps = DriveModel(), list[LadderStep]()
    here = fit(model.keys, None)
    start, fits = here.errors.mean, {model: here}
    visited = {model}
    for rung in range(1, MAX_RUNGS + 1):

        def tried(change: ModelChange, rung: int = rung, here: FoldedFit = here) -> tuple[LadderStep, ModelChange]:
            if change.model not in fits:
                fits[change.model] = fit(change.model.keys, here)
            found = fits[change.model].errors
            return LadderStep(rung, change.words, found.mean, *found.minus(here.errors), taken=False), change

        all_tried = [tried(change) for change in model.neighbors(without)]
        best = _best(all_tried, visited)
        if best is None and FULL not in visited:
            all_tried.append(tried(ModelChange(ALL_PARTS, FULL)))
            best = _best(all_tried[-1:], visited)
        steps += [replace(step, taken=best is not None and step is best[0]) for step, _ in all_tried]
        if best is None:
            break
        model = best[1].model
        here = fits[model]
        visited.add(model)
    terms, rows = tuple(map(entry_text, model.entries)), len(here.residuals)
    return Ladder(terms, start, here.errors.mean, tuple(steps), folds, rows, rows, here.correlation_times, model)


def _best(
    tried: Sequence[tuple[LadderStep, ModelChange]], visited: Collection[DriveModel]
) -> tuple[LadderStep, ModelChange] | None:
    """The change to take, None if there is none."""
    good = [(step, change) for step, change in tried if change.model not in visited and _better(step, change)]
    return min(good, key=lambda one: one[0].error, default=None)


def _better(step: LadderStep, change: ModelChange) -> bool:
    """Whether the changed model predicts better by more than chance, or leaves a part out and predicts as well."""
    if change.leaves_out:
        return step.difference < step.deviation
    before = step.error - step.difference
    least = MIN_COUPLING_GAIN if change.couples else MIN_RELATIVE_GAIN
    return -step.difference > max(MIN_GAIN_DEVIATIONS * step.deviation, least * before)
