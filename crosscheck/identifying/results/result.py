"""The result of an identification."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from crosscheck.identifying.choosing.residual_causes import ResidualCause, residual_causes
from crosscheck.identifying.data_quality.data_quality import DataQuality
from crosscheck.identifying.payload.fitted_currents import FittedCurrents
from crosscheck.identifying.preparing.holding_out import Division
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.identifying.preparing.trials import Baselines
from crosscheck.identifying.results.identified_model import Candidate, IdentifiedModel
from crosscheck.identifying.results.recommending import Recommendation, mean_error, recommendation, rejected
from crosscheck.identifying.results.rejection_reasons import rejection_reasons
from crosscheck.recordings import Recording
from graphdyn import InvalidInput
from graphdyn.display import Displayed
from graphdyn.identification import MethodResult, ResidualStatistics
from graphdyn.identification.data_quality import FoundGravity
from graphdyn.layout import Array
from graphdyn.tables import data_frame

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Identified(IdentifiedModel, Displayed):
    """An identification: the fitted rows, the result of every method, and the recommendation.

    torque_model, comparison, fit and trials are those of the first torque model that was asked for.

    recordings: as read, before filtering
    division: which rows were fitted and which predicted
    others: further torque models on the same rows: those that were asked for, and the links of CAD with fitted drives
    constant: errors of a constant torque on the predicted rows
    gravity: gravity that was found from the recordings; None where it was given
    data_quality: data quality of the recordings of the fit; None where they are too short to tell
    validation_data_quality: of every recording that is predicted and not fitted, likewise
    truth: the true parameters of a virtual robot           (p,)
    currents: the gains that have converted recorded currents to torques; None for recorded torques
    """

    recordings: tuple[Recording, ...]
    division: Division
    preparation: Preparation
    others: tuple[IdentifiedModel, ...] = ()
    constant: ResidualStatistics
    gravity: FoundGravity | None = None
    data_quality: DataQuality | None = None
    validation_data_quality: tuple[DataQuality | None, ...] = ()
    truth: Array | None = None
    currents: FittedCurrents | None = None

    def summary(self) -> str:
        """The recommended method, and the error of every method on rows that were not fitted."""
        chosen = self.recommendation
        rows = [
            f"{candidate.name}: {mean_error(candidate.result):.2%} of the torque on rows that were not fitted"
            for candidate in self.candidates
            if candidate.result.held_out is not None
        ]
        said = f"recommended method: {chosen.name}" if chosen.name else "no usable model"
        return "\n".join([f"{self.subject.name} identified; {said}: {chosen.reason}", *rows])

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every method: error on the rows that were not fitted, as a part of the torque, and consistency.

        Raises ImportError where pandas is missing.
        """
        rows = [candidate for candidate in self.candidates if candidate.result.held_out is not None]
        columns = {
            "held-out error": [mean_error(candidate.result) for candidate in rows],
            "consistent": [one.consistent if one else None for one in (row.result.plausibility for row in rows)],
            "recommended": [candidate.name == self.recommendation.name for candidate in rows],
        }
        return data_frame(columns, [candidate.name for candidate in rows], "method")

    @property
    def predicted_recordings(self) -> tuple[str, ...]:
        """Names of the recordings that are predicted and not fitted, in the order of validation_data_quality."""
        trials = (*self.division.trials, *self.division.aside)
        return tuple(trial.name for trial in trials if trial.own_recording)

    @property
    def models(self) -> tuple[IdentifiedModel, ...]:
        """All torque models: those that were asked for, each followed by that with the links of CAD."""
        return (self, *self.others)

    @property
    def candidates(self) -> tuple[Candidate, ...]:
        """Every method of every torque model: the rows of the tables."""
        return tuple(
            Candidate(model.row_name(result), model, result)
            for model in self.models
            for result in model.comparison.results
        )

    def candidate(self, name: str) -> Candidate:
        """The row of this name in the tables. Raises InvalidInput for an unknown name."""
        for candidate in self.candidates:
            if candidate.name == name:
                return candidate
        known = ", ".join(candidate.name for candidate in self.candidates)
        raise InvalidInput(f"there is no method '{name}'; known: {known}")

    def model_of(self, result: MethodResult) -> IdentifiedModel:
        """The torque model of a result; the first one for a result of another identification."""
        return next((c.model for c in self.candidates if c.result is result), self)

    def body_parameters(self, result: MethodResult) -> Array:
        """Parameters of the links from a result of any of the torque models, as IdentifiedModel.body_parameters."""
        model = self.model_of(result)
        return super().body_parameters(result) if model is self else model.body_parameters(result)

    def fitted_errors(self, result: MethodResult) -> Array:
        """Errors on the fitted rows of a result of any of the torque models, as IdentifiedModel.fitted_errors."""
        model = self.model_of(result)
        return super().fitted_errors(result) if model is self else model.fitted_errors(result)

    def baselines_of(self, model: IdentifiedModel) -> Baselines:
        """Baselines of every result of this model."""
        unknown = model.name if model.cad_of is None else model.cad_of
        cad = next((other for other in self.models if other.cad_of == unknown), None)
        result = None if cad is None else cad.comparison.results[0]
        return Baselines(self.constant, None if result is None else result.held_out or result.training)

    @property
    def baselines(self) -> Baselines:
        """Baselines of every result of the first torque model."""
        return self.baselines_of(self)

    @cached_property
    def recommendation(self) -> Recommendation:
        """The recommended method and the reason; or the reasons why there is none, joint by joint."""
        found = recommendation(self.candidates)
        best = self if found.best is None else self.candidate(found.best).model
        unconstrained = next((m for m in self.models if m.name == best.cad_of), best)
        said = rejection_reasons(
            None if found.best is None else self.candidate(found.best).result,
            best.problem,
            self.torque_model.model.independent_joints,
            self.baselines_of(best),
            self.data_quality,
            unconstrained=unconstrained.problem,
        )
        for name, data_quality in zip(self.predicted_recordings, self.validation_data_quality, strict=True):
            said += (
                tuple(f"{name}, which is predicted: {finding.message}" for finding in data_quality.faults)
                if data_quality
                else ()
            )
        return rejected(found, said)

    @property
    def usable(self) -> bool:
        """Whether a result can be recommended."""
        return self.recommendation.name is not None

    def residual_causes(self, result: MethodResult) -> tuple[ResidualCause, ...]:
        """What the residual of a result still holds over the rows of the fit; the result must have an estimate."""
        curves = self.model_of(result).fit.curves(result.name)
        residuals = np.concatenate([curve.predicted - curve.measured for curve in curves])
        return residual_causes(self.torque_model.model, self.division.fit, self.preparation, residuals)

    def shown(self, name: str | None = None) -> MethodResult | None:
        """The result to show: the named one, otherwise the recommended or rejected one, otherwise the best prediction.

        None if no method has a result. Raises InvalidInput for an unknown method, and for one that failed.
        """
        if name is not None:
            result = self.candidate(name).result
            if result.failure is not None:
                raise InvalidInput(f"{name} has no result: {result.failure}")
            return result
        if self.recommendation.best is not None:
            return self.candidate(self.recommendation.best).result
        answered = [c.result for c in self.candidates if c.result.failure is None]
        return min(answered, key=mean_error) if answered else None


def identified(models: Sequence[IdentifiedModel], **common: Any) -> Identified:
    """The first of the torque models with the others beside it. common: the fields of Identified that all share"""
    main, *further = models
    own = {field.name: getattr(main, field.name) for field in fields(main)}
    return Identified(**own, others=tuple(further), **common)
