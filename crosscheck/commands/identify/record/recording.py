"""What `graphdyn identify 2` says of the recording: what was read, its faults, and what it excites."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from crosscheck.identifying.data_quality.data_quality import Health
from crosscheck.identifying.results.result import Identified
from crosscheck.report.record_fields import Number, taken


@dataclass(frozen=True, kw_only=True)
class IdentifyFindingRecord:
    """One finding."""

    code: str
    """Stable name."""

    severity: Literal["error", "warning", "note"]
    """How bad."""

    file: str
    """Where."""

    column: str | None
    """Where; null: whole rows."""

    rows: Sequence[int]
    """From 0; empty: all."""

    message: str
    """What."""

    remedy: str
    """What to do."""

    lines: int | None
    """Line minus row."""


@dataclass(frozen=True, kw_only=True)
class RecordingRecord:
    """What was fitted and predicted."""

    files: Sequence[str]
    """Fitted files."""

    mapping: str
    """How the columns were found."""

    steps: Sequence[str]
    """What was done to the numbers."""

    decimate: Sequence[int]
    """Factors of the stages."""

    min_speed: float | Sequence[float]
    """Rows of a joint slower than this were not fitted, one for all or one per joint [rad/s or m/s]."""

    fitted_rows: int
    """Rows of the fit."""

    held_out: str
    """What was predicted, in words."""

    held_out_files: Sequence[str]
    """Files of the predicted rows."""

    held_out_rows: int
    """Rows that were predicted."""

    findings: Sequence[IdentifyFindingRecord]
    """What is odd in the files, see recordings.md."""


@dataclass(frozen=True, kw_only=True)
class HealthFindingRecord:
    """A fault of the recording, or a doubt."""

    code: str
    """Stable name."""

    severity: Literal["fault", "warning"]
    """fault: no model is recommended."""

    joints: Sequence[str]
    """Whose columns."""

    message: str
    """What."""

    remedy: str
    """What to do."""

    lines: Sequence[str]
    """Of the mapping file, over those that are there; empty where no mapping helps."""


@dataclass(frozen=True, kw_only=True)
class HealthRecord:
    """What the recordings of the fit show of themselves."""

    findings: Sequence[HealthFindingRecord]
    """In the order in which to correct them."""

    unseen: Sequence[str]
    """What they cannot show, and the test that would."""

    gain: Sequence[Number]
    """Of measured on predicted torque, CAD and fitted drives, per joint, in the order of joint_names."""

    gain_deviation: Sequence[Number]
    """Standard deviation of the gain."""

    gain_share: Sequence[Number]
    """Part of the torque that gain and CAD explain; below 0.3 the gain says little."""

    sign_cost: Sequence[Number]
    """Rise of Σ log ‖e_j‖ with the torque of this joint reversed; the sign is clear from 0.5 on."""

    delay: Number
    """Of all torques behind the motion [s]."""

    delay_deviation: Number
    """Standard deviation of the delay [s]."""

    joint_delays: Sequence[Number]
    """Of each torque, the others as `delay` [s]."""

    joint_delay_deviations: Sequence[Number]
    """Standard deviations of them [s]."""

    residual: Sequence[Number]
    """‖e‖ / ‖τ‖ of the fit with masses and friction not negative."""

    free_residual: Sequence[Number]
    """The same without this bound."""

    standstill: Sequence[Number]
    """Share of rows with |v| ≤ 0.02 rad/s or m/s."""

    clipped: Sequence[Number]
    """Share of rows with the torque held at an end of its range."""


@dataclass(frozen=True, kw_only=True)
class ExcitationRecord:
    """How well the recording excites a group of parameters."""

    name: str
    """Of the group."""

    determined: int
    """Base parameters that the recording determines."""

    structural: int
    """Base parameters that any motion could determine."""

    weakest: Number
    """Smallest singular value of what no other group can imitate; 1 is best."""


def recording_record(found: Identified) -> RecordingRecord:
    fit, test = found.division.fit, [split.test for split in found.division.trials]
    return RecordingRecord(
        files=fit.provenance.files,
        mapping=fit.provenance.mapping,
        steps=fit.provenance.steps,
        decimate=found.preparation.decimate,
        min_speed=np.asarray(found.preparation.min_speed).tolist(),
        fitted_rows=found.fit.n_rows,
        held_out=found.division.words,
        held_out_files=list(dict.fromkeys(name for recording in test for name in recording.provenance.files)),
        held_out_rows=sum(trial.n_rows for trial in found.trials),
        findings=[
            taken(IdentifyFindingRecord, finding) for recording in found.recordings for finding in recording.findings
        ],
    )


def health_record(health: Health) -> HealthRecord:
    measures = health.measures
    return HealthRecord(
        findings=[taken(HealthFindingRecord, finding) for finding in health.findings],
        unseen=health.unseen,
        gain=measures.gains.gain.tolist(),
        gain_deviation=measures.gains.deviation.tolist(),
        gain_share=measures.gains.share.tolist(),
        sign_cost=measures.sign_costs.tolist(),
        delay=measures.lag.common,
        delay_deviation=measures.lag.deviation,
        joint_delays=measures.lag.joints.tolist(),
        joint_delay_deviations=measures.lag.deviations.tolist(),
        residual=measures.errors.tolist(),
        free_residual=measures.free_errors.tolist(),
        standstill=measures.channels.standstill.tolist(),
        clipped=measures.channels.clipped.tolist(),
    )
