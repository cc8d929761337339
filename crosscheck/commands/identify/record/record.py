"""The format `graphdyn identify 2`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.commands.identify.record.comparison import CandidateRecord, candidate_record
from crosscheck.commands.identify.record.methods import MethodRecord, method_record
from crosscheck.commands.identify.record.models import (
    BaseParameterRecord,
    ModelRecord,
    ParameterRecord,
    SettingRecord,
    base_parameter_records,
    model_record,
)
from crosscheck.commands.identify.record.recording import (
    ExcitationRecord,
    HealthRecord,
    RecordingRecord,
    health_record,
    recording_record,
)
from crosscheck.commands.identify.record.shown import ShownRecord, shown_record
from crosscheck.identifying.results.result import Identified
from crosscheck.report.record_fields import FORMAT, Command, Versions, taken
from crosscheck.report.versions import versions
from graphdyn.identification import MethodResult
from graphdyn.identification.data_quality import excitation


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
        base_parameters=base_parameter_records(comparison),
        base_matrix=found.problem.base.matrix.tolist(),
        settings=[taken(SettingRecord, setting) for setting in found.settings],
        exogeneity=found.exogeneity,
        methods=[method_record(found, result) for result in comparison.results],
        model=found.name,
        other_models=[model_record(model) for model in found.others],
        comparison=[candidate_record(candidate) for candidate in found.candidates],
        validation_health=[None if other is None else health_record(other) for other in found.validation_health],
        shown=shown_record(found, shown),
        truth=found.truth,
    )
