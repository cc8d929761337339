"""Identification from recordings of any length, of which only sums and the beginnings are in memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike

from crosscheck.identifying.data_quality.data_quality import data_quality
from crosscheck.identifying.methods.candidate_models import CandidateModel, with_links_of_cad
from crosscheck.identifying.methods.loop_methods import CLOSED_LOOP_METHODS
from crosscheck.identifying.methods.methods import method_named
from crosscheck.identifying.methods.pinocchio_method import WithPinocchio
from crosscheck.identifying.methods.wrench_method import FromWrenches
from crosscheck.identifying.predicted_parts import PredictedParts
from crosscheck.identifying.preparing.holding_out import Division, Fold
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.identifying.results.baselines import constant_model, fitted_constant
from crosscheck.identifying.results.identified_model import HeldOutPrediction, IdentifiedModel
from crosscheck.identifying.results.result import Identified
from crosscheck.recordings import PartitionedRecording, Provenance, Recording, concatenated
from crosscheck.reference.subject import IDENTIFY_CLOSED, Robot, Subject, refuse_chords, subject
from graphdyn import InvalidInput
from graphdyn.identification import (
    CHECKED_POSES,
    Estimator,
    GeneralizedLeastSquares,
    MaximumLikelihood,
    Problem,
    ReweightedLeastSquares,
    RobustConsistent,
    TorqueModel,
    Tunable,
    compare_methods,
    one_thread,
)
from urdf import Reading, ReadingKeywords

EXCERPT_ROWS = 100_000
"""Rows from the beginnings of the logs that are in memory, for the data quality and the curves of a page."""

HELD_OUT_SHARE = 0.25
"""Part of every log, at its end, that is predicted unless other logs are."""

MAX_NAMED_LOGS = 3
"""Largest number of predicted logs that are listed by name."""

METHODS_OF_SUMS = ("ols", "wls", "ridge", "essential", "consistent", "entropic", "pullback", "log-cholesky", "tls")
"""Methods that need no more than the sums of all parts."""

STANDARD_METHODS_OF_SUMS = ("ols", "wls", "ridge", "consistent", "entropic")
"""The default methods of METHODS_OF_SUMS."""

EXOGENEITY_NEEDS_ROWS = "not tested: the test needs single rows, and recordings of any length are summed up"
"""Text on the exogeneity of the regressor for recordings of any length."""

SAMPLE_METHODS = (
    GeneralizedLeastSquares,
    MaximumLikelihood,
    ReweightedLeastSquares,
    RobustConsistent,
    WithPinocchio,
    FromWrenches,
    *CLOSED_LOOP_METHODS,
)
"""Methods that read the samples, some of them repeatedly."""


def identify_long(
    robot: Robot,
    data: PartitionedRecording,
    models: Sequence[CandidateModel],
    *,
    validate: PartitionedRecording | None = None,
    min_speed: ArrayLike = 0.0,
    poses: int = CHECKED_POSES,
    progress: Callable[[str, int], None] | None = None,
    **reading: Unpack[ReadingKeywords],
) -> Identified:
    """Identify from recordings that do not fit into memory. They are read several times, part by part.

    data, validate: joints in the order of the robot, those of the robot if left out; validate: logs to predict, the end
        of every log of `data` if left out
    min_speed: as in Preparation
    progress: called with the name of a step, and a number of rows

    The result is that of the whole data. Its `recordings`, `division`, curves and data quality are those of the
    beginnings of the logs. Raises as identify; InvalidInput for methods that read samples; NoWorkers.
    """
    compared = subject(robot, Reading.of(identify_long, reading))
    refuse_chords(compared.model, IDENTIFY_CLOSED)
    joints = compared.model.independent_joints
    data = data if data.joints else replace(data, joints=joints)
    validate = replace(validate, joints=joints) if validate is not None and not validate.joints else validate
    candidates = with_links_of_cad(models)
    for candidate in candidates:
        _estimators(candidate)
        _refuse_terms_of_samples(candidate.of(compared.model))
    fitted = data if validate is not None else replace(data, between=(0.0, 1 - HELD_OUT_SHARE))
    predicted = replace(data, between=(1 - HELD_OUT_SHARE, 1.0)) if validate is None else validate
    preparation = Preparation(cutoff=data.cutoff, min_speed=min_speed)
    begun, begun_ahead = (_beginnings(part) for part in (fitted, predicted))
    begin, ahead = _excerpt(fitted, begun, preparation), _excerpt(predicted, begun_ahead, preparation)
    first = candidates[0].of(compared.model)
    if validate is None:
        division = Division(begin, [Fold("", begin, ahead)], f"the last {100 * HELD_OUT_SHARE:g} % of every log")
    else:
        _refuse_shared(fitted, predicted)
        names = _names(predicted)
        division = Division(begin, [Fold(names, begin, ahead, own_recording=True)], f"all of {names}")

    def say(what: str) -> Callable[[int], None] | None:
        return None if progress is None else lambda rows: progress(what, rows)

    with one_thread():
        main, *further = (
            _fitted(compared, candidate, fitted, predicted, division, preparation, poses, say)
            for candidate in candidates
        )
        mean, told = constant_model(compared.model), say("constant torque")
        constant = fitted_constant(Problem(mean, fitted, progress=told), Problem(mean, predicted, progress=told))
    return Identified(
        **{field.name: getattr(main, field.name) for field in fields(main)},
        recordings=tuple(begun),
        division=division,
        preparation=preparation,
        others=tuple(further),
        constant=constant,
        data_quality=data_quality(first, begun, preparation),
        validation_data_quality=() if validate is None else (data_quality(first, begun_ahead, preparation),),
    )


def _estimators(candidate: CandidateModel) -> list[Estimator]:
    found = [method_named(method) if isinstance(method, str) else method for method in candidate.methods]
    for estimator in found:
        if isinstance(estimator, SAMPLE_METHODS):
            raise InvalidInput(
                f"{estimator.name} looks at samples, of which only sums are kept here; use {', '.join(METHODS_OF_SUMS)}"
            )
    return found


def _refuse_terms_of_samples(torque_model: TorqueModel) -> None:
    if torque_model.has_memory or any(isinstance(term, Tunable) for term in torque_model.terms):
        raise InvalidInput(
            "friction with memory, and settings that are to be found, need all samples, of which only sums are kept "
            "here; leave them out, or give numbers"
        )


def _fitted(
    compared: Subject,
    candidate: CandidateModel,
    fitted: PartitionedRecording,
    predicted: PartitionedRecording,
    division: Division,
    preparation: Preparation,
    poses: int,
    say: Callable[[str], Callable[[int], None] | None],
) -> IdentifiedModel:
    torque_model = candidate.of(compared.model)
    name = candidate.name or "torque model"
    fit, ahead = (
        Problem(torque_model, data, min_speed=preparation.min_speed, progress=say(f"{name}: {what}"))
        for data, what in ((fitted, "fit"), (predicted, "prediction"))
    )
    comparison = compare_methods(fit, _estimators(candidate), ahead, poses=poses)

    def prediction(problem: Problem, excerpt: Recording, of: str) -> PredictedParts:
        answered = [result for result in comparison.results if result.estimate is not None]
        parameters = {result.name: result.estimate.parameters for result in answered if result.estimate}
        statistics = {result.name: getattr(result, of) for result in answered}
        small = preparation.problem(torque_model, excerpt)
        curves = HeldOutPrediction(small, preparation.times(excerpt), parameters, statistics)
        return PredictedParts(problem, (), parameters, statistics, division.words, excerpt=curves)

    return IdentifiedModel(
        subject=compared,
        torque_model=torque_model,
        fit=prediction(fit, division.fit, "training"),
        trials=(prediction(ahead, division.trials[0].test, "held_out"),),
        comparison=comparison,
        exogeneity=EXOGENEITY_NEEDS_ROWS,
        name=candidate.name,
        cad_of=candidate.cad_of,
    )


def _refuse_shared(fitted: PartitionedRecording, predicted: PartitionedRecording) -> None:
    files = {file.resolve() for source in fitted.logs for file in source.log.files}
    for file in (file for source in predicted.logs for file in source.log.files):
        if file.resolve() in files:
            raise InvalidInput(f"{file}: its rows are fitted and predicted; predict another log")


def _beginnings(data: PartitionedRecording) -> list[Recording]:
    """Beginnings as read, of every log, or of every second, third, … one if all would be too many rows."""
    shortest = max(source.shortest for source in data.logs)
    some = data.logs[:: -(-len(data.logs) * shortest // EXCERPT_ROWS)]
    each = max(EXCERPT_ROWS // len(some), shortest)
    read = [source.read(source.begin, min(source.begin + each, source.end)) for source in some]
    return [replace(recording, findings=source.findings) for recording, source in zip(read, some, strict=True)]


def _excerpt(data: PartitionedRecording, begun: list[Recording], preparation: Preparation) -> Recording:
    """The beginnings, prepared; the provenance is that of the whole."""
    found = concatenated([preparation.differentiated(recording) for recording in begun])
    source = found.provenance
    steps = (*source.steps, f"data quality and curves from the first {len(found.t)} rows")
    whole = Provenance(tuple(str(log.log.path) for log in data.logs), data.logs[0].mapping.source, steps)
    return replace(found, provenance=whole, file=np.zeros(len(found.t), dtype=np.intp))


def _names(data: PartitionedRecording) -> str:
    names = [str(source.log.path) for source in data.logs]
    more = len(names) - MAX_NAMED_LOGS
    return ", ".join(names[:MAX_NAMED_LOGS]) + (f" and {more} more" if more > 0 else "")
