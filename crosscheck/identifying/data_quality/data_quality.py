"""Data quality of recordings as text: faults of each joint, their correction, and faults that no test reveals."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from crosscheck.identifying.data_quality.causes import cause_in_words, remedy_of
from crosscheck.identifying.data_quality.finding import QualityFinding, finding_of
from crosscheck.identifying.data_quality.halves_and_delays import findings_of_halves, hints_of_delays
from crosscheck.identifying.data_quality.mapping_lines import mapping_lines, recorded_columns
from crosscheck.identifying.data_quality.remedies import change_in_words
from crosscheck.identifying.data_quality.row_findings import (
    clock_findings,
    clock_rate,
    held_findings,
    held_rows,
    measured_parts,
    model_findings,
)
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from graphdyn import InvalidInput
from graphdyn.identification import TorqueModel, Tunable
from graphdyn.identification.data_quality import (
    MAX_FEW_VALUES,
    MAX_RATE_GAIN_ERROR,
    Change,
    RecordingQuality,
    TooShort,
    assess_recording,
)
from graphdyn.identification.terms import AsymmetricCoulomb, Coulomb, Drift

MIN_CLIPPED_SHARE = 0.01
"""Share of clipped rows from which there is a warning."""

MAX_CLIPPED_SHARE = 0.05
"""Share of clipped rows up to which a recording may be used: more of them distort friction and gravity."""

MIN_STANDSTILL_SHARE = 0.9
"""Share of standstill from which a joint counts as hardly moving."""

MIN_UNRELATED_RESIDUAL = 0.9
"""Residual of the fit, relative to the deviation of the torque from its mean, from which the two are unrelated."""

MIN_CLEAR_SHARE, MAX_GAIN_DEVIATION = 0.3, 0.25
"""Smallest share of the torque that the model must explain, and largest relative σ, for a gain to indicate a wrong
unit."""

MIN_UNITS_GAIN, MAX_GAIN_RATIO = 2.0, 2.5
"""Gain from which the unit of all torques is suspicious, and the factor within which all joints must then agree: wrong
CAD values are wrong by another factor in each link."""

MIN_AGREEING_GAIN = 10.0
"""Gain from which the agreement of most joints is enough: CAD may be wrong in a wrist, but not by a common factor of
ten in the heavier links, which most joints carry."""


@dataclass(frozen=True, eq=False)
class DataQuality:
    """Data quality of the recordings of the fit.

    measures: the numbers
    findings: in the order in which to correct them
    unseen: faults that they cannot show, and the test that would, in sentences
    """

    measures: RecordingQuality
    findings: tuple[QualityFinding, ...]
    unseen: tuple[str, ...]

    @property
    def faults(self) -> tuple[QualityFinding, ...]:
        return tuple(finding for finding in self.findings if finding.severity == "fault")


def data_quality(
    torque_model: TorqueModel, recordings: Sequence[Recording], preparation: Preparation
) -> DataQuality | None:
    """Data quality of all recordings together, with the mapping of the first; None if they are too short."""
    held = held_rows(recordings)
    measured = measured_parts(recordings, held)
    found = None
    for part in (measured, recordings) if measured else (recordings,):
        if (found := _assessed(torque_model, part, preparation)) is not None:
            break
    if found is None:
        return None
    said = [
        *held_findings(held, found.joint_names),
        *model_findings(found),
        *clock_findings(found),
        *_faults(found, recordings[0]),
        *_of_channels(found),
    ]
    sound = not any(finding.severity == "fault" for finding in said)  # else gains and fits suffer from it
    said += findings_of_halves(found)
    if sound:
        said += list(_of_fits(found)) or ([] if found.contradictions.any() else _of_units(found, recordings[0]))
    said += hints_of_delays(found)
    return DataQuality(found, tuple(said), _unseen(found))


def _assessed(
    torque_model: TorqueModel, recordings: Sequence[Recording], preparation: Preparation
) -> RecordingQuality | None:
    """The numbers of recordings, with the mapping of the first; None if they are too short."""
    try:
        parts = [preparation.pieces(recording) for recording in recordings]
    except InvalidInput:  # too few rows to filter, which the fit then refuses
        return None
    try:
        return assess_recording(
            row_by_row(torque_model),
            [piece for pieces, _ in parts for piece in pieces],
            torques=[tau for _, torques in parts for tau in torques],
            columns=recorded_columns(recordings[0]),
            min_speed=preparation.min_speed,
        )
    except TooShort:
        return None


def row_by_row(torque_model: TorqueModel) -> TorqueModel:
    """The torque model with Coulomb friction in place of friction with memory, and without drifts: rows are
    independent.

    Settings to be found have their initial values.
    """
    terms = [term.make(**term.start) if isinstance(term, Tunable) else term for term in torque_model.terms]
    terms = [term for term in terms if not isinstance(term, Drift) and not getattr(term, "has_memory", False)]
    if torque_model.has_memory and not any(isinstance(term, Coulomb | AsymmetricCoulomb) for term in terms):
        terms.append(Coulomb())
    return replace(torque_model, terms=terms, expected={})


def _faults(found: RecordingQuality, recording: Recording) -> Iterator[QualityFinding]:
    """Faults in the order of their correction, and hints."""
    changes = [fault.change for fault in found.faults if isinstance(fault.change, Change)]
    lines = dict(zip(map(id, changes), mapping_lines(changes, recording), strict=True))
    for fault in found.faults:
        remedy = remedy_of(fault.change)
        if fault.instead:
            words = (cause_in_words(other, found.joint_names, found.gravity) for other in fault.instead)
            remedy += f", unless {'; or '.join(dict.fromkeys(words))}, which would fit about as well"
        when = "undone after those above" if fault is not found.faults[0] else "undone"
        yield finding_of(found, fault, "fault", f"{{what}}: {when}", remedy, lines.get(id(fault.change), ()))
    for fault in found.hints:
        remedy = "no reason to refuse the recording; check it where you can"
        yield finding_of(found, fault, "hint", "perhaps {what}: undone", remedy)


def _of_channels(found: RecordingQuality) -> Iterator[QualityFinding]:
    names, raw = found.joint_names, found.channels
    for what, pairs in (("positions", raw.duplicated_positions), ("torques", raw.duplicated_torques)):
        for i, j in pairs:
            message = f"the {what} of {names[i]} and {names[j]} are the same signal"
            yield QualityFinding("duplicated", "fault", (names[i], names[j]), message, "name the right column for each")
    for j in raw.constant_torques:
        message = f"the torque of {names[j]} does not change"
        remedy = "name the right column, or lock the joint"
        yield QualityFinding("constant-torque", "fault", (names[j],), message, remedy)
    explained = {
        j
        for fault in found.faults
        for j in fault.change.joints
        if isinstance(fault.change, Change) and fault.change.alone
    }
    for j, gain in enumerate(raw.velocity_gain):
        if abs(gain - 1) > MAX_RATE_GAIN_ERROR and j not in explained and np.isnan(clock_rate(found)):
            message = f"v of {names[j]} is {gain:.3g} times the rate of q"
            remedy = "correct unit, sign or column of [v] or [q], or leave [v] out"
            yield QualityFinding("velocity", "fault", (names[j],), message, remedy)
    for j in np.flatnonzero(raw.clipped > MIN_CLIPPED_SHARE).tolist():
        if raw.torque_values[j] <= MAX_FEW_VALUES:
            continue
        message = f"the torque of {names[j]} is held at an end of its range in {100 * raw.clipped[j]:.0f} % of the rows"
        severity: Literal["fault", "warning"] = "fault" if raw.clipped[j] > MAX_CLIPPED_SHARE else "warning"
        yield QualityFinding("clipped", severity, (names[j],), message, "use --drop saturation")
    for j in np.flatnonzero(raw.torque_values <= MAX_FEW_VALUES).tolist():
        if j not in raw.constant_torques:
            message = (
                f"the torque of {names[j]} takes {raw.torque_values[j]} values only: it was recorded in coarse steps"
            )
            yield QualityFinding("quantized", "warning", (names[j],), message, "record it with more digits or bits")
    for j in np.flatnonzero(raw.standstill > MIN_STANDSTILL_SHARE).tolist():
        message = f"{names[j]} stands still in {100 * raw.standstill[j]:.0f} % of the rows"
        yield QualityFinding("standstill", "warning", (names[j],), message, "record a motion of it, or lock it")


def _of_units(found: RecordingQuality, recording: Recording) -> list[QualityFinding]:
    """Findings on the unit of all torques; none if links and drives give little information."""
    g = found.gains
    with np.errstate(invalid="ignore"):
        clear = np.flatnonzero((g.share >= MIN_CLEAR_SHARE) & (g.deviation <= MAX_GAIN_DEVIATION * np.abs(g.gain)))
    if not clear.size:
        return []
    sizes = np.abs(g.gain[clear])
    alike = max((sizes[(least <= sizes) & (sizes <= MAX_GAIN_RATIO * least)] for least in sizes), key=len)
    most = 1 < len(alike) > len(clear) / 2
    usual = float(np.median(alike if most else sizes))
    away = max(usual, 1 / usual)
    if away < MIN_UNITS_GAIN:
        return []
    listed = ", ".join(f"{found.joint_names[j]} {g.gain[j]:.3g} ± {g.deviation[j]:.2g}" for j in clear)
    message = f"measured torques are {usual:.3g} times those of CAD and drives ({listed})"
    if most and (len(alike) == len(clear) or away >= MIN_AGREEING_GAIN):
        remedy = (
            "give their unit, or their gain in N m at the joint; torques at the motors need "
            '[transmission] and side = "motor"; if the unit is right, the masses of the robot\'s file are not'
        )
        n = len(found.joint_names)
        change = Change("scaled torque", tuple(range(n)), torque=np.eye(n) / usual, factor=usual)
        (lines,) = mapping_lines([change], recording)
        return [QualityFinding("torque-unit", "fault", found.joint_names, message, remedy, lines)]
    remedy = "check unit and gains, and the masses of the robot's file: the joints do not agree on a factor"
    return [QualityFinding("torque-unit", "warning", found.joint_names, message, remedy)]


def _of_fits(found: RecordingQuality) -> Iterator[QualityFinding]:
    contradicted = np.any(found.contradictions, axis=0).tolist()
    for j, name in enumerate(found.joint_names):
        variation, left = found.variation[j], found.free_errors[j]
        if not contradicted[j] and variation > 0 and left > MIN_UNRELATED_RESIDUAL * variation:
            message = (
                f"the torque of {name} has nothing to do with the motion: no parameters leave less than "
                f"{100 * left / variation:.0f} % of its variation"
            )
            remedy = "check its column; it may be noise around a mean, or another signal"
            yield QualityFinding("unrelated", "fault", (name,), message, remedy)


def _unseen(found: RecordingQuality) -> tuple[str, ...]:
    """Changes after which the recording would fit equally well, and tests that would reveal them."""
    said = []
    names = found.joint_names
    if zeros := _joints(found, "zero"):
        said.append(
            f"a zero offset of 90° or 180° at {zeros}; move to the zero pose and compare it with the URDF's picture"
        )
    if gears := _joints(found, "reversed joint"):
        said.append(
            f"sign of the gear of {gears}, position and torque reversed together; jog the joint forth and look "
            "which way it turns"
        )
    others = [change for change in found.unseen if change.kind not in ("zero", "reversed joint")]
    for change in sorted(others, key=lambda change: [other.kind for other in others].index(change.kind)):
        said.append(f"whether {change_in_words(change, names)}; move that joint alone, and look at the columns")
    said.append(
        "the URDF of a similar robot, whose kinematics fit nearly as well; measure the flange in a few poses, and "
        "compare identified parameters with CAD in σ (table of parameters)"
    )
    return tuple(dict.fromkeys(said))


def _joints(found: RecordingQuality, kind: str) -> str:
    numbers = dict.fromkeys(j for change in found.unseen if change.kind == kind for j in change.joints)
    return ", ".join(found.joint_names[j] for j in numbers)
