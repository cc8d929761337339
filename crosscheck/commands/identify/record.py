"""The format `graphdyn identify 3`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import numpy as np

from crosscheck.commands.identify.gains_record import CurrentsRecord
from crosscheck.identifying import FittedCurrents
from crosscheck.identifying.choosing.ladder import Ladder
from crosscheck.identifying.choosing.residual_causes import ResidualCause
from crosscheck.identifying.data_quality.data_quality import DataQuality
from crosscheck.identifying.results.identified_model import Candidate, HeldOutPrediction, IdentifiedModel
from crosscheck.identifying.results.link_findings import (
    LinkFinding,
    contradicted_masses,
    link_findings,
    reached_limits,
)
from crosscheck.identifying.results.parameters import (
    BaseRow,
    BodyRow,
    base_rows,
    body_rows,
    correlation_of,
    deviations_of,
)
from crosscheck.identifying.results.recommending import joint_errors, mean_error
from crosscheck.identifying.results.result import Identified
from crosscheck.recordings import RecordingFinding
from crosscheck.report.records.record import CommandRecord, Keywords, Number, Numbers, Record, attribute, written
from graphdyn.identification import ContradictedMass, MethodComparison, MethodResult, ReachedLimit, ResidualSizes
from graphdyn.identification.currents import gain_deviations
from graphdyn.identification.data_quality import Excitation, VisibleSizes, excitation
from graphdyn.layout import Array
from graphdyn.model import PARAMETER_NAMES

Inertial = Annotated[
    Mapping[str, float],
    Keywords(
        properties={
            name: {"description": "In the link frame [kg, kg m, kg m²].", "type": "number"} for name in PARAMETER_NAMES
        },
        required=list(PARAMETER_NAMES),
    ),
]


class MethodRecord(Record, of=MethodResult, leave_out=("estimate", "plausibility")):
    """One method; null for numbers that it does not give.

    mean_error: mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows
    fitted_relative: ‖e‖ / ‖τ‖ over the rows that counted in the fit, per joint, in the order of joint_names
    settings: numbers that the method chose
    remarks: what the reader has to know
    """

    mean_error: Number
    fitted_relative: Numbers | None
    parameters: Numbers | None = attribute("estimate.parameters")
    base_values: Numbers | None
    standard_deviations: Numbers | None
    block_deviations: Numbers | None
    relative_deviations: Numbers | None = attribute()
    noise: Numbers | None = attribute("estimate.noise")
    iterations = attribute("estimate.iterations")
    settings: Mapping[str, Number]
    remarks: Sequence[str]
    consistent = attribute("plausibility.consistent")
    pseudo_inertia_eigenvalues: Numbers | None = attribute("plausibility.pseudo_inertia_eigenvalues")
    positive_definite = attribute("plausibility.positive_definite")
    poses = attribute("plausibility.poses")
    smallest_mass_matrix_eigenvalue: Number = attribute("plausibility.smallest_mass_matrix_eigenvalue")


class BaseParameterRecord(Record):
    """A base parameter.

    name: in standard parameters
    symbol: as Khalil writes it: XX_2, or XXR_2 where others are regrouped into it
    unit: of the parameter
    """

    name: str
    symbol: str
    unit: str


class TorqueModelRecord(Record):
    """What was found with one torque model.

    base_parameters: of the recording, in order
    base_matrix: B with base parameters = B · parameters, one row per base parameter
    methods: every method, in the order asked for
    """

    parameters = attribute("torque_model.columns")
    rank = attribute("comparison.rank")
    structural_rank = attribute("comparison.structural_rank")
    condition_number = attribute("comparison.condition_number")
    base_parameters: Sequence[BaseParameterRecord]
    base_matrix: Sequence[Sequence[float]] = attribute("problem.base.matrix")
    methods: Sequence[MethodRecord]


class ModelRecord(TorqueModelRecord, of=IdentifiedModel, only=("name", "exogeneity", "settings")):
    """A further torque model.

    cad_links: the links are those of CAD, only the drives are fitted
    """

    cad_links: bool


class VisibleSizesRecord(Record, of=VisibleSizes):
    """The smallest faults that a recording shows, null where it shows none of the sizes that were planted.

    zeros: of joints [°]
    gear_ratios, torque_gains, torque_drifts: of joints, relative; a drift from begin to end
    delays: of single torques [s]
    tilt: of the mounting, about the horizontal axis that shows it least [°]
    clock: of its rate, relative
    load: attached in the middle, at the origin of the last link [kg]
    """

    zeros: Numbers
    gear_ratios: Numbers
    torque_gains: Numbers
    torque_drifts: Numbers
    delays: Numbers
    tilt: Number
    clock: Number
    load: Number


class DataQualityRecord(Record, of=DataQuality, leave_out=("measures",)):
    """What the recordings of the fit show of themselves."""

    gain: Numbers = attribute("measures.gains.gain")
    gain_deviation: Numbers = attribute("measures.gains.deviation")
    gain_share: Numbers = attribute("measures.gains.share")
    sign_cost: Numbers = attribute("measures.sign_costs")
    delay: Number = attribute("measures.lag.common")
    delay_deviation: Number = attribute("measures.lag.deviation")
    joint_delays: Numbers = attribute("measures.lag.joints")
    joint_delay_deviations: Numbers = attribute("measures.lag.deviations")
    residual: Numbers = attribute("measures.errors")
    free_residual: Numbers = attribute("measures.free_errors")
    standstill: Numbers = attribute("measures.channels.standstill")
    clipped: Numbers = attribute("measures.channels.clipped")
    visible: VisibleSizesRecord | None = attribute("measures.visible")


class LadderRecord(Record, of=Ladder, leave_out=("model",)):
    """How the terms of the drives were chosen."""


class ResidualCauseRecord(Record, of=ResidualCause):
    """What may explain a part of the residual of the shown result."""


class RecordingRecord(Record, of=Identified, only=()):
    """What was fitted and predicted.

    fitted_rows: rows of the fit
    held_out_files: files of the predicted rows
    held_out_rows: rows that were predicted
    findings: what is odd in the files, see recordings.md
    """

    files = attribute("division.fit.provenance.files")
    mapping = attribute("division.fit.provenance.mapping")
    steps = attribute("division.fit.provenance.steps")
    decimate = attribute("preparation.decimate")
    min_speed: float | Sequence[float] = attribute("preparation.min_speed")
    fitted_rows = attribute("fit.n_rows")
    held_out = attribute("division.words")
    held_out_files: Sequence[str]
    held_out_rows: int
    findings: Sequence[RecordingFinding]


class TrialRecord(Record):
    """Errors of one result on some of the predicted rows.

    name: of the rows: a fold, a file, or an interval
    mean_error: mean over the joints of ‖e‖ / ‖τ‖ over moving rows
    everything: over all rows
    moving: per joint over its rows with |v| > 0.02 rad/s or m/s
    """

    name: str
    mean_error: Number
    everything: ResidualSizes
    moving: ResidualSizes


class CandidateRecord(Record, of=Candidate, only=("name",)):
    """A row of the tables: a torque model and a method.

    method: its name, as in methods of the model
    cad_links: the links are those of CAD, only the drives are fitted
    mean_error: mean over the joints of the held-out ‖e‖ / ‖τ‖ over moving rows; null where there is no answer
    trials: rows that were predicted and choose: fold by fold, file by file
    aside: rows that were predicted and choose nothing
    """

    model = attribute("model.name")
    method: str = attribute("result.name")
    cad_links: bool
    mean_error: Number
    trials: Sequence[TrialRecord]
    aside: Sequence[TrialRecord]


class ShownParameterRecord(Record, of=BaseRow, leave_out=("symbol",)):
    """A base parameter of the shown result."""


class IdentifyBodyRecord(Record, of=BodyRow, only=("name",)):
    """A link of the shown result.

    cad: as given
    identified: what --urdf writes
    center_of_mass: in link axes [m]
    """

    cad: Inertial
    identified: Inertial
    center_of_mass: Numbers = attribute("center")
    pseudo_inertia_eigenvalue = attribute("eigenvalue")


class ContradictedMassRecord(Record, of=ContradictedMass):
    """A mass of CAD that the recording contradicts; an empty body for all masses together, whose sums these are."""


class ReachedLimitRecord(Record, of=ReachedLimit):
    """A value within 2 % of its limit: the recording does not determine it; an empty body for the total mass."""


class LinkFindingRecord(Record, of=LinkFinding):
    """A finding about a link, or about all for an empty link, in words."""


class ShownRecord(Record):
    """The result in the tables: the chosen one, else the recommended one, else the one that predicts best; null where
    no method has an answer.

    name: as in comparison
    method: its name
    deviations: whose standard deviations these are
    correlation_time: until the autocorrelation of the residual behind them has fallen to 1/e, at the slowest joint [s]
    correlation_times: how many times as long the fitted rows are; null for a white residual
    lower_bound: block deviations are a lower bound: fewer than 80 correlation times; null without them
    base_parameters: of the recording
    bodies: links
    reached_limits: values that the limits of the links hold
    contradicted_masses: masses of CAD that the recording contradicts
    link_findings: both in words
    """

    name: str
    method: str
    deviations: str
    correlation_time: Number
    correlation_times: Number
    lower_bound: bool | None
    base_parameters: Sequence[ShownParameterRecord]
    bodies: Sequence[IdentifyBodyRecord]
    reached_limits: Sequence[ReachedLimitRecord]
    contradicted_masses: Sequence[ContradictedMassRecord]
    link_findings: Sequence[LinkFindingRecord]


class IdentifyRecord(
    TorqueModelRecord,
    CommandRecord,
    of=Identified,
    only=("exogeneity", "settings", "truth"),
    format="graphdyn identify 3",
):
    """Parameters of a robot from recordings by several methods, and which one to trust.

    joint_names: order of all numbers per joint
    gravity: found from the recordings, in world axes [m/s²]; null where it was given
    gravity_deviation: standard deviation of its direction [°]
    data_quality: what the recordings of the fit show of themselves; null where they are too short
    excitation: how well they excite each group of parameters
    recording: what was fitted and predicted
    model: name of the torque model that parameters, rank, base_parameters, methods and what is between them belong to:
        the first one; empty where only one was asked for
    other_models: further torque models on the same rows: those that were asked for, and the links of CAD with fitted
        drives
    comparison: every method of every torque model, in the order of the tables
    validation_data_quality: what every recording that is predicted and not fitted shows of itself; null where it is too
        short
    ladder: how the terms of the drives of the first model were chosen; null where they were given
    residual_causes: what the residual of the shown result still holds; empty where the recording is too short to tell
    shown: the result in the tables
    currents: gains that have converted recorded currents; null for recorded torques
    """

    robot = attribute("subject.name")
    file = attribute("subject.file")
    file_sha256 = attribute("subject.file_sha256")
    locked = attribute("subject.locked")
    chain: Sequence[str] | None = attribute("subject.chain")
    joint_names: Sequence[str] = attribute("torque_model.model.independent_joints")
    usable = attribute()
    recommended = attribute("recommendation.name")
    reason = attribute("recommendation.reason")
    best = attribute("recommendation.best")
    rejection_reasons = attribute("recommendation.rejection_reasons")
    gravity: Sequence[float] | None = attribute("gravity.gravity")
    gravity_deviation: Number = attribute("gravity.deviation")
    data_quality: DataQualityRecord | None
    excitation: Sequence[Excitation]
    ladder: LadderRecord | None
    residual_causes: Sequence[ResidualCauseRecord]
    recording: RecordingRecord
    gap: Sequence[float] = attribute("comparison.gap")
    undetermined = attribute("comparison.undetermined")
    lost = attribute("comparison.lost")
    nearly_undetermined = attribute("comparison.nearly_undetermined")
    model: str = attribute("name")
    other_models: Sequence[ModelRecord]
    comparison: Sequence[CandidateRecord]
    validation_data_quality: Sequence[DataQualityRecord | None]
    shown: ShownRecord | None
    currents: CurrentsRecord | None


def record(found: Identified, shown: MethodResult | None, command: Sequence[str]) -> dict[str, Any]:
    """Everything. shown: the result that the terminal shows"""
    return written(
        IdentifyRecord,
        found,
        command=command,
        excitation=excitation(found.problem),
        recording=_recording(found),
        base_parameters=_base_parameters(found.comparison),
        methods=[_method(found, result) for result in found.comparison.results],
        other_models=[_model(model) for model in found.others],
        comparison=[_candidate(candidate) for candidate in found.candidates],
        residual_causes=() if shown is None else found.residual_causes(shown),
        shown=None if shown is None else _shown(found, shown),
        currents=None if found.currents is None else _currents(found, found.currents),
    )


def _currents(found: Identified, currents: FittedCurrents) -> dict[str, Any]:
    deviations = gain_deviations(found.problem.equations, currents.gains)
    return written(CurrentsRecord, currents, base_deviations=deviations)


def _model(model: IdentifiedModel) -> dict[str, Any]:
    return written(
        ModelRecord,
        model,
        cad_links=model.cad_of is not None,
        base_parameters=_base_parameters(model.comparison),
        methods=[_method(model, result) for result in model.comparison.results],
    )


def _base_parameters(found: MethodComparison) -> list[dict[str, str]]:
    rows = zip(found.base_names, found.base_symbols, found.base_units, strict=True)
    return [{"name": name, "symbol": symbol, "unit": unit} for name, symbol, unit in rows]


def _method(model: IdentifiedModel, result: MethodResult) -> dict[str, Any]:
    estimate = result.estimate
    return written(
        MethodRecord,
        result,
        mean_error=mean_error(result) if estimate else None,
        fitted_relative=model.fitted_errors(result) if estimate else None,
        settings=estimate.settings if estimate else {},
        remarks=estimate.remarks if estimate else (),
    )


def _recording(found: Identified) -> dict[str, Any]:
    test = [split.test for split in found.division.trials]
    return written(
        RecordingRecord,
        found,
        held_out_files=list(dict.fromkeys(name for recording in test for name in recording.provenance.files)),
        held_out_rows=sum(trial.n_rows for trial in found.trials),
        findings=[finding for recording in found.recordings for finding in recording.findings],
    )


def _candidate(candidate: Candidate) -> dict[str, Any]:
    model, result = candidate.model, candidate.result

    def errors(predictions: Sequence[HeldOutPrediction]) -> list[dict[str, Any]]:
        return [
            written(TrialRecord, statistics, name=prediction.name, mean_error=np.nanmean(joint_errors(statistics)))
            for prediction in predictions
            if (statistics := prediction.statistics.get(result.name)) is not None
        ]

    return written(
        CandidateRecord,
        candidate,
        cad_links=model.cad_of is not None,
        mean_error=None if result.failure is not None else mean_error(result),
        trials=errors(model.trials),
        aside=errors(model.aside),
    )


def _shown(found: Identified, result: MethodResult) -> dict[str, Any]:
    source, words = deviations_of(found, result)
    correlation = None if source is None else correlation_of(found, source)
    return written(
        ShownRecord,
        name=found.model_of(result).row_name(result),
        method=result.name,
        deviations=words,
        correlation_time=correlation.time if correlation else None,
        correlation_times=correlation.times if correlation else None,
        lower_bound=correlation.lower_bound if correlation else None,
        base_parameters=base_rows(found, result),
        bodies=[
            written(IdentifyBodyRecord, row, cad=_named(row.cad_parameters), identified=_named(row.parameters))
            for row in body_rows(found, result)
        ],
        reached_limits=reached_limits(found, result),
        contradicted_masses=contradicted_masses(found, result),
        link_findings=link_findings(found, result),
    )


def _named(parameters: Array) -> dict[str, float]:
    return dict(zip(PARAMETER_NAMES, parameters, strict=True))
