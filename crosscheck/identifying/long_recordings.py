"""Identification from recordings of any length, of which only sums and the beginnings are in memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from crosscheck.identifying.choosing.chosen import with_chosen_drives
from crosscheck.identifying.choosing.ladder import Ladder
from crosscheck.identifying.data_quality.data_quality import DataQuality, data_quality
from crosscheck.identifying.methods.candidate_models import CandidateModel, with_links_of_cad
from crosscheck.identifying.methods.link_limits import with_limits
from crosscheck.identifying.methods.loop_methods import CLOSED_LOOP_METHODS
from crosscheck.identifying.methods.methods import WithPinocchio
from crosscheck.identifying.methods.wrench_method import FromWrenches
from crosscheck.identifying.preparing.holding_out import Division, Fold, HeldOut
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.identifying.preparing.trials import constant_model, fitted_constant
from crosscheck.identifying.results.identified_model import HeldOutPrediction, IdentifiedModel, PredictedParts
from crosscheck.identifying.results.result import Identified, identified
from crosscheck.recordings import PartitionedRecording, Provenance, Recording, concatenated
from crosscheck.recordings.parts.free_memory import give_back_free_memory
from crosscheck.reference.subject import Subject
from graphdyn import InvalidInput
from graphdyn.errors import first_of
from graphdyn.identification import (
    ClosedLoop,
    Estimator,
    GeneralizedLeastSquares,
    MaximumLikelihood,
    PhysicalLimits,
    Problem,
    ReweightedLeastSquares,
    RobustConsistent,
    TorqueModel,
    Tunable,
    compare_methods,
    one_thread,
)

Progress = Callable[[str, int], None]
"""Called with the name of a step, and the number of its steps or rows."""

EXCERPT_ROWS = 25_000
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


@dataclass(frozen=True, eq=False)
class LongRecordings:
    """Recordings of any length of a robot, to be fitted and to be predicted.

    ladders: how terms of the drives were chosen, from the beginnings of the fitted logs, by the name of the model
    begun, begun_ahead: beginnings of the logs as they were read
    division: the same prepared, for curves
    limits: for the methods that keep any
    """

    compared: Subject
    candidates: Sequence[CandidateModel]
    ladders: Mapping[str, Ladder]
    fitted: PartitionedRecording
    predicted: PartitionedRecording
    begun: list[Recording]
    begun_ahead: list[Recording]
    division: Division
    preparation: Preparation
    limits: PhysicalLimits

    @classmethod
    def of(
        cls,
        compared: Subject,
        candidates: Sequence[CandidateModel],
        data: PartitionedRecording,
        held_out: HeldOut | PartitionedRecording | None,
        preparation: Preparation | None,
        loop: ClosedLoop | None,
        limits: PhysicalLimits,
    ) -> LongRecordings:
        """The parts, with the joints of the robot if they name none. Raises InvalidInput for what needs all samples."""
        preparation = preparation or Preparation(cutoff=data.cutoff)
        _refuse_needs_of_samples(data, held_out, preparation, loop)
        for candidate in candidates:
            _refuse_methods_of_samples(candidate.estimators)
            _refuse_terms_of_samples(candidate.of(compared.model))
        joints = compared.model.independent_joints
        data = data if data.joints else replace(data, joints=joints)
        if isinstance(held_out, PartitionedRecording):
            fitted, predicted = data, held_out if held_out.joints else replace(held_out, joints=joints)
            _refuse_shared(fitted, predicted)
            names, words = _names(predicted), f"all of {_names(predicted)}"
        else:
            fitted = replace(data, between=(0.0, 1 - HELD_OUT_SHARE))
            predicted = replace(data, between=(1 - HELD_OUT_SHARE, 1.0))
            names, words = "", f"the last {100 * HELD_OUT_SHARE:g} % of every log"
        begun, begun_ahead = (_beginnings(part) for part in (fitted, predicted))
        begin, ahead = _excerpt(fitted, begun, preparation), _excerpt(predicted, begun_ahead, preparation)
        division = Division(begin, [Fold(names, begin, ahead, own_recording=bool(names))], words)
        # friction with memory needs whole runs, which the fit of all parts does not have
        chosen, ladders = with_chosen_drives(candidates, compared.model, begin, preparation, memory=False)
        candidates = with_links_of_cad(chosen)
        return cls(compared, candidates, ladders, fitted, predicted, begun, begun_ahead, division, preparation, limits)

    def identified(self, poses: int, progress: Progress | None) -> Identified:
        """The results of all torque models."""
        first, mean = self.candidates[0].of(self.compared.model), constant_model(self.compared.model)
        quality, quality_ahead = self._data_quality(first)
        with one_thread():
            models = [self._model(candidate, poses, progress) for candidate in self.candidates]
            constant = fitted_constant(*self._problems(mean, 0.0, ("constant torque", "constant torque"), progress))
        return identified(
            models,
            recordings=tuple(self.begun),
            division=self.division,
            preparation=self.preparation,
            constant=constant,
            data_quality=quality,
            validation_data_quality=quality_ahead,
        )

    def _data_quality(self, torque_model: TorqueModel) -> tuple[DataQuality | None, tuple[DataQuality | None, ...]]:
        """Data quality of the fitted recordings, and of the predicted ones if they are others."""
        fitted = data_quality(torque_model, self.begun, self.preparation)
        ahead: tuple[DataQuality | None, ...] = ()
        if self.division.trials[0].own_recording:
            ahead = (data_quality(torque_model, self.begun_ahead, self.preparation),)
        give_back_free_memory()
        return fitted, ahead

    def _problems(
        self, model: TorqueModel, min_speed: ArrayLike, steps: tuple[str, str], progress: Progress | None
    ) -> tuple[Problem, Problem]:
        """The problem of the fit and that of the prediction. steps: what to tell while their rows are read"""

        def told(step: str) -> Callable[[int], None] | None:
            return None if progress is None else lambda rows: progress(step, rows)

        fit, ahead = (
            Problem(model, data, min_speed=min_speed, progress=told(step))
            for data, step in zip((self.fitted, self.predicted), steps, strict=True)
        )
        return fit, ahead

    def _model(self, candidate: CandidateModel, poses: int, progress: Progress | None) -> IdentifiedModel:
        torque_model = candidate.of(self.compared.model)
        name, division, preparation = candidate.name or "torque model", self.division, self.preparation
        steps = (f"{name}: fit", f"{name}: prediction")
        fit, ahead = self._problems(torque_model, preparation.min_speed, steps, progress)
        comparison = compare_methods(fit, with_limits(candidate.estimators, self.limits), ahead, poses=poses)

        def prediction(problem: Problem, excerpt: Recording, of: str) -> PredictedParts:
            answered = [result for result in comparison.results if result.estimate is not None]
            parameters = {result.name: result.estimate.parameters for result in answered if result.estimate}
            statistics = {result.name: getattr(result, of) for result in answered}
            small = preparation.problem(torque_model, excerpt)
            curves = HeldOutPrediction(small, preparation.times(excerpt), parameters, statistics)
            return PredictedParts(problem, (), parameters, statistics, division.words, excerpt=curves)

        return IdentifiedModel(
            subject=self.compared,
            torque_model=torque_model,
            fit=prediction(fit, division.fit, "training"),
            trials=(prediction(ahead, division.trials[0].test, "held_out"),),
            comparison=comparison,
            exogeneity=EXOGENEITY_NEEDS_ROWS,
            limits=self.limits,
            name=candidate.name,
            cad_of=candidate.cad_of,
            ladder=self.ladders.get(candidate.name),
        )


def _refuse_needs_of_samples(
    data: PartitionedRecording,
    held_out: HeldOut | PartitionedRecording | None,
    preparation: Preparation,
    loop: ClosedLoop | None,
) -> None:
    prepared = preparation.decimate or preparation.torque_hold or preparation.velocity != "recorded"
    if prepared or preparation.cutoff != data.cutoff:
        raise InvalidInput(
            "a PartitionedRecording is filtered by its own cutoff, and prepared in no other way; give "
            "Preparation(cutoff=data.cutoff, min_speed=…), or a Recording"
        )
    if loop is not None or not (held_out is None or isinstance(held_out, PartitionedRecording)):
        raise InvalidInput(
            "control loops, and other ways to hold out rows than their last quarter or another PartitionedRecording, "
            "need the recording in memory; give a Recording"
        )


def _refuse_methods_of_samples(estimators: Sequence[Estimator]) -> None:
    for estimator in estimators:
        if isinstance(estimator, SAMPLE_METHODS):
            raise InvalidInput(
                f"{estimator.name} looks at samples, of which only sums are kept here; use {', '.join(METHODS_OF_SUMS)}"
            )


def _refuse_terms_of_samples(torque_model: TorqueModel) -> None:
    if torque_model.has_memory or any(isinstance(term, Tunable) for term in torque_model.terms):
        raise InvalidInput(
            "friction with memory, and settings that are to be found, need all samples, of which only sums are kept "
            "here; leave them out, or give numbers"
        )


def _refuse_shared(fitted: PartitionedRecording, predicted: PartitionedRecording) -> None:
    files = {source.log.told(file).resolve() for source in fitted.logs for file in source.log.files}
    for file in (source.log.told(file) for source in predicted.logs for file in source.log.files):
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
    return first_of((source.log.path for source in data.logs), MAX_NAMED_LOGS)
