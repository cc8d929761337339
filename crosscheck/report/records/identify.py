"""The format `graphdyn identify 2`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np

from crosscheck.identifying.identified_model import Candidate, HeldOutPrediction, IdentifiedModel
from crosscheck.identifying.parameters import base_rows, body_rows, correlation_of, deviations_of
from crosscheck.identifying.result import Identified
from crosscheck.identifying.result_errors import joint_errors, mean_error
from crosscheck.report.records._fields import FORMAT, Command, Keywords, Number, Versions, taken
from crosscheck.report.records.identify_recording import (
    ExcitationRecord,
    HealthRecord,
    RecordingRecord,
    health_record,
    recording_record,
)
from crosscheck.report.versions import versions
from graphdyn._inertia import PARAMETER_NAMES
from graphdyn.identification import MethodComparison, MethodResult, ResidualStatistics
from graphdyn.identification.health import excitation

Inertial = Annotated[
    Mapping[str, float],
    Keywords(
        properties={
            name: {"description": "In the link frame [kg, kg m, kg m²].", "type": "number"} for name in PARAMETER_NAMES
        },
        required=list(PARAMETER_NAMES),
    ),
]


@dataclass(frozen=True, kw_only=True)
class ParameterRecord:
    """A standard parameter."""

    name: str
    """Of the parameter."""

    symbol: str
    """As Khalil and Gautier write it."""

    unit: str
    """Of the parameter."""


@dataclass(frozen=True, kw_only=True)
class BaseParameterRecord:
    """A base parameter."""

    name: str
    """In standard parameters."""

    symbol: str
    """As Khalil writes it: XX_2, or XXR_2 where others are regrouped into it."""

    unit: str
    """Of the parameter."""


@dataclass(frozen=True, kw_only=True)
class SizesRecord:
    """Sizes of residuals."""

    count: Sequence[int]
    """Rows, per joint, in the order of joint_names."""

    mean: Sequence[Number]
    """Of predicted minus measured torque, per joint, in the order of joint_names [N m or N]."""

    rms: Sequence[Number]
    """Root mean square of it, per joint, in the order of joint_names [N m or N]."""

    largest: Sequence[Number]
    """Largest absolute value of it, per joint, in the order of joint_names [N m or N]."""

    relative: Sequence[Number]
    """‖e‖ / ‖τ‖ with the measured torque, per joint, in the order of joint_names."""


@dataclass(frozen=True, kw_only=True)
class StatisticsRecord:
    """Sizes of the residuals; null where there are none."""

    everything: SizesRecord
    """Over all rows."""

    moving: SizesRecord
    """Per joint over its rows with |v| > 0.02 rad/s or m/s."""

    durbin_watson: Sequence[Number]
    """2 for white noise, per joint, in the order of joint_names."""

    ljung_box_p: Sequence[Number]
    """Below 0.05: not white, per joint, in the order of joint_names; null where several trials were put together."""

    correlation_length: Sequence[Number]
    """Rows after which the autocorrelation has fallen to 1/e, 0 for a white residual, per joint, in the order of
    joint_names; null where several trials were put together.
    """


@dataclass(frozen=True, kw_only=True)
class MethodRecord:
    """One method."""

    name: str
    """As in the tables."""

    reference: str
    """Where it is published."""

    assumptions: str
    """What has to hold."""

    needs: str
    """What has to be measured."""

    failure: str | None
    """Why there is no answer; null where there is one."""

    seconds: Number
    """Of the estimation [s]."""

    mean_error: Number
    """Mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows."""

    held_out: StatisticsRecord | None
    """Errors on the predicted rows, of all trials together."""

    training: StatisticsRecord | None
    """Errors on the rows of the fit, slow ones included."""

    fitted_relative: Sequence[Number] | None
    """‖e‖ / ‖τ‖ over the rows that counted in the fit, per joint, in the order of joint_names."""

    parameters: Sequence[Number] | None
    """Standard parameters."""

    base_values: Sequence[Number] | None
    """Base parameters."""

    standard_deviations: Sequence[Number] | None
    """Of the base parameters, for white noise."""

    block_deviations: Sequence[Number] | None
    """The same, allowing for correlation in time: jackknife over time blocks."""

    relative_deviations: Sequence[Number] | None
    """100 block_deviations / |value| [%]."""

    noise: Sequence[Number] | None
    """Standard deviation of the torque as the method sees it, per joint, in the order of joint_names [N m or N]."""

    iterations: int | None
    """How often the equations were solved."""

    settings: Mapping[str, Number]
    """Numbers that the method chose."""

    remarks: Sequence[str]
    """What the reader has to know."""

    consistent: bool | None
    """Every link can be a real body."""

    pseudo_inertia_eigenvalues: Sequence[Number] | None
    """The smallest of every link."""

    positive_definite: int | None
    """Poses with a positive definite mass matrix."""

    poses: int | None
    """Poses that were tried."""

    smallest_mass_matrix_eigenvalue: Number
    """Over all poses [kg m² or kg]."""


@dataclass(frozen=True, kw_only=True)
class ShownParameterRecord:
    """A base parameter of the shown result."""

    name: str
    """In standard parameters."""

    unit: str
    """Of the numbers."""

    cad: float
    """Of the robot as given; drives are zero."""

    value: float
    """Identified."""

    deviation: Number
    """Standard deviation for white noise."""

    block_deviation: Number
    """Allowing for correlation in time: jackknife over time blocks."""

    relative_deviation: Number
    """100 block_deviation / |value| [%]."""

    truth: Number
    """True value, of a simulated robot."""

    error: Number
    """value minus truth."""


@dataclass(frozen=True, kw_only=True)
class IdentifyBodyRecord:
    """A link of the shown result."""

    name: str
    """Of the link."""

    cad: Inertial
    """As given."""

    identified: Inertial
    """What --urdf writes."""

    center_of_mass: Sequence[Number]
    """In link axes [m]."""

    pseudo_inertia_eigenvalue: float
    """The smallest; below zero: no real body."""


@dataclass(frozen=True, kw_only=True)
class ShownRecord:
    """The result in the tables: the chosen one, else the recommended one, else the one that predicts best; null where
    no method has an answer.
    """

    name: str
    """As in comparison."""

    method: str
    """Name of the method."""

    deviations: str
    """Whose standard deviations these are."""

    correlation_time: Number
    """Until the autocorrelation of the residual behind them has fallen to 1/e, at the slowest joint [s]."""

    correlation_times: Number
    """How many times as long the fitted rows are; null for a white residual."""

    lower_bound: bool | None
    """Block deviations are a lower bound: fewer than 80 correlation times; null without them."""

    base_parameters: Sequence[ShownParameterRecord]
    """Base parameters."""

    bodies: Sequence[IdentifyBodyRecord]
    """Links."""


@dataclass(frozen=True, kw_only=True)
class TrialRecord:
    """Errors of one result on some of the predicted rows."""

    name: str
    """Of the rows: a fold, a file, or an interval."""

    mean_error: Number
    """Mean over the joints of ‖e‖ / ‖τ‖ over moving rows."""

    everything: SizesRecord
    """Over all rows."""

    moving: SizesRecord
    """Per joint over its rows with |v| > 0.02 rad/s or m/s."""


@dataclass(frozen=True, kw_only=True)
class CandidateRecord:
    """A row of the tables: a torque model and a method."""

    name: str
    """As in the tables, and in recommended, best and shown."""

    model: str
    """Name of the torque model; empty for the only one."""

    method: str
    """Name of the method, as in methods of the model."""

    cad_links: bool
    """The links are those of CAD, only the drives are fitted."""

    mean_error: Number
    """Mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows; null where there is no answer."""

    trials: Sequence[TrialRecord]
    """Rows that were predicted and choose: fold by fold, file by file."""

    aside: Sequence[TrialRecord]
    """Rows that were predicted and choose nothing."""


@dataclass(frozen=True, kw_only=True)
class SettingRecord:
    """A setting of a torque model's term that was found together with the parameters."""

    name: str
    """Of term and setting, such as coulomb width."""

    values: Sequence[float]
    """One per joint."""

    at_end: Sequence[bool]
    """Per joint, whether it is at the end of the range of the search, because the recording does not say."""


@dataclass(frozen=True, kw_only=True)
class ModelRecord:
    """A further torque model."""

    name: str
    """As in the tables."""

    cad_links: bool
    """The links are those of CAD, only the drives are fitted."""

    parameters: Sequence[ParameterRecord]
    """Standard parameters of the torque model, in order."""

    rank: int
    """Number of base parameters that the recording determines."""

    structural_rank: int
    """Number that any motion could determine."""

    condition_number: float
    """Of the regressor, joints weighted by their torque, columns at unit length."""

    exogeneity: str
    """Of the regressor, in words: the result of the Durbin-Wu-Hausman test, or why it is not made."""

    base_parameters: Sequence[BaseParameterRecord]
    """Base parameters of the recording, in order."""

    base_matrix: Sequence[Sequence[float]]
    """B with base parameters = B · parameters, one row per base parameter."""

    settings: Sequence[SettingRecord]
    """Those that were found together with the parameters."""

    methods: Sequence[MethodRecord]
    """Every method, in the order asked for."""


@dataclass(frozen=True, kw_only=True)
class IdentifyRecord:
    """Parameters of a robot from recordings by several methods, and which one to trust."""

    format: Annotated[Literal["graphdyn identify 2"], FORMAT] = "graphdyn identify 2"

    versions: Versions = field(default_factory=versions)

    command: Command

    robot: str
    """As given, or the name of a RobotModel."""

    file: str | None
    """Its URDF; null where a RobotModel was given."""

    file_sha256: str | None
    """Of the file."""

    locked: Mapping[str, float]
    """Value per joint that was held still [rad or m]."""

    chain: Sequence[str] | None
    """Base link and tip link where an arm was cut out."""

    joint_names: Sequence[str]
    """Order of all numbers per joint."""

    usable: bool
    """A model was found that can be trusted: see reason."""

    recommended: str | None
    """Name of the method to trust; null where there is none."""

    reason: str
    """Why this one, or why none."""

    best: str | None
    """Name of the method that would be recommended without the doubts; null where no result is consistent."""

    doubts: Sequence[str]
    """Why it is not recommended, joint by joint."""

    health: HealthRecord | None
    """What the recordings of the fit show of themselves; null where they are too short."""

    excitation: Sequence[ExcitationRecord]
    """How well they excite each group of parameters."""

    recording: RecordingRecord
    """What was fitted and predicted."""

    parameters: Sequence[ParameterRecord]
    """Standard parameters of the torque model, in order."""

    rank: int
    """Number of base parameters that the recording determines."""

    structural_rank: int
    """Number that any motion could determine."""

    gap: Sequence[float]
    """Smallest accepted and largest rejected pivot, relative to the first."""

    condition_number: float
    """Of the regressor, joints weighted by their torque, columns at unit length."""

    exogeneity: str
    """Of the regressor, in words: the result of the Durbin-Wu-Hausman test, or why it is not made."""

    base_parameters: Sequence[BaseParameterRecord]
    """Base parameters of the recording, in order."""

    base_matrix: Sequence[Sequence[float]]
    """B with base parameters = B · parameters, one row per base parameter."""

    settings: Sequence[SettingRecord]
    """Those that were found together with the parameters."""

    undetermined: Sequence[str]
    """Standard parameters that are determined in combinations only, or not at all."""

    lost: Sequence[str]
    """Base parameters of the structure that the recording does not determine by themselves."""

    methods: Sequence[MethodRecord]
    """Every method, in the order asked for."""

    model: str
    """Name of the torque model that parameters, rank, base_parameters, methods and what is between them belong to: the
    first one; empty where only one was asked for."""

    other_models: Sequence[ModelRecord]
    """Further torque models on the same rows: those that were asked for, and the links of CAD with fitted drives."""

    comparison: Sequence[CandidateRecord]
    """Every method of every torque model, in the order of the tables."""

    validation_health: Sequence[HealthRecord | None]
    """What every recording that is predicted and not fitted shows of itself; null where it is too short."""

    shown: ShownRecord | None
    """The result in the tables: the chosen one, else the recommended one, else the one that predicts best; null where
    no method has an answer.
    """

    truth: Sequence[float] | None
    """True standard parameters of a simulated robot; null for a recording."""


def record(found: Identified, shown: MethodResult | None, command: Sequence[str]) -> IdentifyRecord:
    """Everything. shown: the result that the terminal shows"""
    comparison, subject = found.comparison, found.subject
    return taken(
        IdentifyRecord,
        comparison,
        command=command,
        robot=subject.name,
        file=subject.file,
        file_sha256=subject.file_sha256,
        locked=subject.locked,
        chain=subject.chain,
        joint_names=found.torque_model.model.independent_joints,
        usable=found.usable,
        recommended=found.recommendation.name,
        reason=found.recommendation.reason,
        best=found.recommendation.best,
        doubts=found.recommendation.doubts,
        health=None if found.health is None else health_record(found.health),
        excitation=[taken(ExcitationRecord, group) for group in excitation(found.problem)],
        recording=recording_record(found),
        parameters=[taken(ParameterRecord, column) for column in found.torque_model.columns],
        base_parameters=_base_parameters(comparison),
        base_matrix=found.problem.base.matrix.tolist(),
        settings=[taken(SettingRecord, setting) for setting in found.settings],
        exogeneity=found.exogeneity,
        methods=[_method(found, result) for result in comparison.results],
        model=found.name,
        other_models=[_model(model) for model in found.others],
        comparison=[_candidate(candidate) for candidate in found.candidates],
        validation_health=[None if other is None else health_record(other) for other in found.validation_health],
        shown=_shown(found, shown),
        truth=found.truth,
    )


def _base_parameters(comparison: MethodComparison) -> list[BaseParameterRecord]:
    return [
        BaseParameterRecord(name=name, symbol=symbol, unit=unit)
        for name, symbol, unit in zip(
            comparison.base_names, comparison.base_symbols, comparison.base_units, strict=True
        )
    ]


def _model(model: IdentifiedModel) -> ModelRecord:
    return taken(
        ModelRecord,
        model.comparison,
        name=model.name,
        cad_links=model.cad_of is not None,
        parameters=[taken(ParameterRecord, column) for column in model.torque_model.columns],
        base_parameters=_base_parameters(model.comparison),
        base_matrix=model.problem.base.matrix.tolist(),
        settings=[taken(SettingRecord, setting) for setting in model.settings],
        exogeneity=model.exogeneity,
        methods=[_method(model, result) for result in model.comparison.results],
    )


def _candidate(candidate: Candidate) -> CandidateRecord:
    model, result = candidate.model, candidate.result

    def errors(predictions: Sequence[HeldOutPrediction]) -> list[TrialRecord]:
        return [
            TrialRecord(
                name=prediction.name,
                mean_error=float(np.nanmean(joint_errors(statistics))),
                everything=taken(SizesRecord, statistics.everything),
                moving=taken(SizesRecord, statistics.moving),
            )
            for prediction in predictions
            if (statistics := prediction.statistics.get(result.name)) is not None
        ]

    return CandidateRecord(
        name=candidate.name,
        model=model.name,
        method=result.name,
        cad_links=model.cad_of is not None,
        mean_error=None if result.failure is not None else mean_error(result),
        trials=errors(model.trials),
        aside=errors(model.aside),
    )


def _method(found: IdentifiedModel, result: MethodResult) -> MethodRecord:
    estimate, plausible = result.estimate, result.plausibility
    answered = estimate is not None and plausible is not None
    return taken(
        MethodRecord,
        result,
        mean_error=mean_error(result) if answered else None,
        held_out=_statistics(result.held_out),
        training=_statistics(result.training),
        fitted_relative=found.fitted_errors(result) if answered else None,
        parameters=estimate.parameters if estimate else None,
        noise=estimate.noise if estimate else None,
        iterations=estimate.iterations if estimate else None,
        settings=estimate.settings if estimate else {},
        remarks=estimate.remarks if estimate else (),
        consistent=plausible.consistent if plausible else None,
        pseudo_inertia_eigenvalues=plausible.pseudo_inertia_eigenvalues if plausible else None,
        positive_definite=plausible.positive_definite if plausible else None,
        poses=len(plausible.mass_matrix_eigenvalues) if plausible else None,
        smallest_mass_matrix_eigenvalue=plausible.mass_matrix_eigenvalues.min() if plausible else None,
    )


def _statistics(statistics: ResidualStatistics | None) -> StatisticsRecord | None:
    if statistics is None:
        return None
    return taken(
        StatisticsRecord,
        statistics,
        everything=taken(SizesRecord, statistics.everything),
        moving=taken(SizesRecord, statistics.moving),
    )


def _shown(found: Identified, result: MethodResult | None) -> ShownRecord | None:
    if result is None:
        return None
    source, words = deviations_of(found, result)
    correlation = None if source is None else correlation_of(found, source)
    return ShownRecord(
        name=found.model_of(result).row_name(result),
        method=result.name,
        deviations=words,
        correlation_time=correlation.time if correlation else None,
        correlation_times=correlation.times if correlation else None,
        lower_bound=correlation.lower_bound if correlation else None,
        base_parameters=[taken(ShownParameterRecord, row) for row in base_rows(found, result)],
        bodies=[
            IdentifyBodyRecord(
                name=row.name,
                cad=dict(zip(PARAMETER_NAMES, row.cad_parameters, strict=True)),
                identified=dict(zip(PARAMETER_NAMES, row.parameters, strict=True)),
                center_of_mass=row.center.tolist(),
                pseudo_inertia_eigenvalue=row.eigenvalue,
            )
            for row in body_rows(found, result)
        ],
    )
