"""Identification of one torque model with several methods on the rows of a division."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from crosscheck.identifying.choosing.ladder import Ladder
from crosscheck.identifying.methods.candidate_models import CandidateModel
from crosscheck.identifying.methods.link_limits import with_limits
from crosscheck.identifying.methods.loop_methods import in_loop, with_exogeneity
from crosscheck.identifying.methods.methods import WithPinocchio
from crosscheck.identifying.methods.wrench_method import FromWrenches
from crosscheck.identifying.preparing.holding_out import Division, Fold
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.identifying.preparing.trials import pooled, problems_of
from crosscheck.identifying.results.identified_model import HeldOutPrediction, IdentifiedModel
from crosscheck.recordings import Recording
from crosscheck.reference.subject import Subject
from graphdyn.identification import (
    ClosedLoop,
    Estimator,
    MethodComparison,
    MethodResult,
    PhysicalLimits,
    Problem,
    ResidualStatistics,
    compare_methods,
    residual_statistics,
    tuned,
)
from graphdyn.layout import Array

TRIAL_POSES = 1
"""Number of poses in which the mass matrix of a trial is tested: one, because a trial only predicts."""


def identified_model(
    subject: Subject,
    candidate: CandidateModel,
    division: Division,
    preparation: Preparation,
    *,
    loop: ClosedLoop | None,
    poses: int,
    limits: PhysicalLimits,
    progress: Callable[[str], None],
    ladder: Ladder | None = None,
) -> IdentifiedModel:
    """The model with the results of every method on the rows of the fit, and on those of every trial.

    loop: as prepared, for the methods that simulate it
    limits: for the methods that keep any
    progress: called with the name of every method that begins
    ladder: how the terms of the drives were chosen
    """
    torque_model = candidate.of(subject.model)
    estimators = with_limits(_with_pinocchio(in_loop(candidate.estimators, loop), subject), limits)

    def say(what: str) -> None:
        progress(f"{candidate.name}: {what}" if candidate.name else what)

    fit = preparation.problem(torque_model, division.fit)
    torque_model, settings = tuned(fit)
    if settings:
        fit = preparation.problem(torque_model, division.fit)
    comparison = compare_methods(fit, _fitted_to(estimators, division.fit), poses=poses, progress=say)
    comparison, exogeneity = with_exogeneity(comparison, fit, loop)
    if all(trial.train is division.fit for trial in division.trials):
        trials = [_predicted(trial, fit, division.fit, preparation, comparison) for trial in division.trials]
    else:
        trials = [_tried(trial, fit, division.fit, preparation, estimators, say) for trial in division.trials]
    comparison = replace(comparison, results=tuple(_with_trials(result, trials) for result in comparison.results))
    return IdentifiedModel(
        subject=subject,
        torque_model=torque_model,
        fit=HeldOutPrediction(fit, preparation.times(division.fit), *_fitted(comparison)),
        trials=tuple(prediction for prediction, _ in trials),
        aside=tuple(_predicted(trial, fit, division.fit, preparation, comparison)[0] for trial in division.aside),
        comparison=comparison,
        name=candidate.name,
        cad_of=candidate.cad_of,
        settings=settings,
        exogeneity=exogeneity,
        ladder=ladder,
        limits=limits,
    )


Tried = tuple[HeldOutPrediction, MethodComparison]
"""Prediction of a trial, and the results that it comes from."""


def _fitted(comparison: MethodComparison) -> tuple[dict[str, Array], dict[str, ResidualStatistics]]:
    """Parameters and residuals of every method that has a result."""
    answered = [result for result in comparison.results if result.estimate is not None]
    return (
        {result.name: result.estimate.parameters for result in answered if result.estimate},
        {result.name: result.training for result in answered if result.training},
    )


def _predicted(
    trial: Fold, fit: Problem, recording: Recording, preparation: Preparation, comparison: MethodComparison
) -> Tried:
    """The rows of a trial, predicted by existing results."""
    _, problem, times = problems_of(trial, fit, recording, preparation)
    parameters, _ = _fitted(comparison)
    statistics = residual_statistics(problem, np.array(list(parameters.values()))) if parameters else []
    by_method = dict(zip(parameters, statistics, strict=True))
    return HeldOutPrediction(problem, times, parameters, by_method, trial.name), comparison


def _tried(
    trial: Fold,
    fit: Problem,
    recording: Recording,
    preparation: Preparation,
    estimators: Sequence[Estimator],
    say: Callable[[str], None],
) -> Tried:
    """The rows of a trial, predicted by results from its own rows."""
    train, *_ = problems_of(trial, fit, recording, preparation)
    found = compare_methods(train, _fitted_to(estimators, trial.train), poses=TRIAL_POSES, progress=say)
    return _predicted(trial, fit, recording, preparation, found)


def _with_trials(result: MethodResult, trials: Sequence[Tried]) -> MethodResult:
    """The result with the errors of all trials together; failed if it fails in one."""
    if result.failure is not None:
        return result
    failures = [why for _, found in trials if (why := found.of(result.name).failure) is not None]
    if failures:
        return replace(result, failure=f"in {len(failures)} of {len(trials)} folds: {failures[0]}", estimate=None)
    return replace(result, held_out=pooled([prediction.statistics[result.name] for prediction, _ in trials]))


def _fitted_to(estimators: Sequence[Estimator], recording: Recording) -> list[Estimator]:
    """The estimators; those that need wrenches receive the recording."""
    return [
        replace(estimator, recording=recording)
        if isinstance(estimator, FromWrenches) and not estimator.recording
        else estimator
        for estimator in estimators
    ]


def _with_pinocchio(estimators: Sequence[Estimator], robot: Subject) -> list[Estimator]:
    """The estimators; those on Pinocchio's regressor use its own reading of the file, if it can read it."""
    wanting = [
        estimator for estimator in estimators if isinstance(estimator, WithPinocchio) and not estimator.pinocchio
    ]
    if not wanting or robot.file is None:
        return list(estimators)
    from crosscheck.reference.pinocchio_model import PinocchioModel, PinocchioRefuses

    try:
        pinocchio = PinocchioModel.from_urdf(Path(robot.file), robot.model, robot.reading)
    except PinocchioRefuses:  # Pinocchio's model is then built from ours, as `graphdyn crosscheck` reports
        return list(estimators)
    return [replace(estimator, pinocchio=pinocchio) if estimator in wanting else estimator for estimator in estimators]
