"""The data quality of the recordings of an identification: what was measured of each joint, findings, what nobody can
see."""

from __future__ import annotations

import numpy as np

from crosscheck.identifying import Identified, IdentifiedModel
from crosscheck.identifying.data_quality.data_quality import MIN_CLEAR_SHARE, DataQuality
from crosscheck.report.report import Block, Code, Column, Note, Notes, Prose, Row, Section, State, Table
from graphdyn.identification.data_quality import RecordingQuality, excitation

QUALITY_NOTE = "Lines of the file of --mapping, over those that are there"
SEVERITY_STATES: dict[str, State] = {"fault": "disagrees", "warning": "undecided", "hint": "plain"}
TOO_SHORT_NOTE = "The recording is too short to tell whether signs, columns, units and delays are right."


def data_quality_section(found: Identified) -> Section:
    """Empty blocks are not shown, so that a recording without findings has tables alone."""
    data_quality = found.data_quality
    if data_quality is None:
        blocks: tuple[Block, ...] = (Prose(TOO_SHORT_NOTE),)
    else:
        blocks = (
            _joints(data_quality.measures),
            *_findings(data_quality),
            *_visible(data_quality.measures),
            *_of_predicted(found),
            Notes(
                tuple(map(Note, data_quality.unseen)),
                title="What this recording cannot show, and the test that would",
            ),
        )
    return Section("data_quality", "Data quality of the recording", blocks)


def _joints(measures: RecordingQuality) -> Table:
    late = measures.lag
    caption = (
        "gain: of measured on predicted torque, CAD and fitted drives; in brackets where CAD explains less than "
        f"{100 * MIN_CLEAR_SHARE:.0f} % of the torque; sign: by how much the residual grows with this torque reversed, "
        f"geometric mean over the joints; delay: of this torque behind the motion, of all {1e3 * late.common:.1f} ± "
        f"{1e3 * late.deviation:.1f} ms; residual: ‖e‖/‖τ‖ of the fit with masses and friction not negative, and "
        "without this bound"
    )
    rows = []
    for j, name in enumerate(measures.joint_names):
        rows.append(
            Row(
                (
                    name,
                    (measures.gains.gain[j], measures.gains.deviation[j], measures.gains.share[j]),
                    float(np.exp(measures.sign_costs[j] / len(measures.joint_names))),
                    (1e3 * late.joints[j], 1e3 * late.deviations[j]),
                    100 * measures.errors[j],
                    100 * measures.free_errors[j],
                    100 * measures.channels.standstill[j],
                    100 * measures.channels.clipped[j],
                )
            )
        )
    return Table(
        (
            Column("joint", "name"),
            Column("gain", "number", form=_gain),
            Column("sign", "number", "×", ".2f", meaning="residual with this torque reversed, relative"),
            Column("delay", "number", "ms", form=lambda numbers: "{:.1f} ± {:.1f}".format(*numbers)),
            Column("residual", "number", "%", ".3g"),
            Column("without bounds", "number", "%", ".3g"),
            Column("standstill", "number", "%", ".0f", meaning="rows with |v| ≤ 0.02 rad/s or m/s"),
            Column("clipped", "number", "%", ".0f", meaning="rows with the torque held at an end of its range"),
        ),
        tuple(rows),
        caption=caption,
    )


def _visible(measures: RecordingQuality) -> tuple[Block, ...]:
    """The smallest faults that the recording would show, joint by joint, and of the whole arm."""
    sizes = measures.visible
    if sizes is None:
        return ()
    clock, load = _least(100 * sizes.clock, " %"), _least(sizes.load, " kg")
    whole = (
        f"a mounting turned by {_least(sizes.tilt, '°')}, a clock wrong by {clock}, a load of {load} attached halfway"
    )
    caption = (
        "the smallest faults that this recording would show, planted in it: a smaller one, or any where there is a –, "
        f"is not found, and changes the result. Of the whole arm: {whole}"
    )
    columns = [100 * sizes.gear_ratios, 100 * sizes.torque_gains, 100 * sizes.torque_drifts, 1e3 * sizes.delays]
    rows = tuple(
        Row((name, *(float(x) if np.isfinite(x) else None for x in own)))
        for name, *own in zip(measures.joint_names, sizes.zeros, *columns, strict=True)
    )
    return (
        Table(
            (
                Column("joint", "name"),
                Column("zero", "number", "°", ".2g"),
                Column("gear ratio", "number", "%", ".2g"),
                Column("torque", "number", "%", ".2g", meaning="gain of this torque against the others"),
                Column("drift", "number", "%", ".2g", meaning="of this torque from begin to end"),
                Column("delay", "number", "ms", ".2g", meaning="of this torque behind the others"),
            ),
            rows,
            caption=caption,
        ),
    )


def _least(value: float, unit: str) -> str:
    return f"{value:.2g}{unit}" if np.isfinite(value) else "any size (none shows)"


def _gain(numbers: tuple[float, float, float]) -> str:
    gain, deviation, share = numbers
    text = f"{gain:.3g} ± {deviation:.1g}"
    return text if share >= MIN_CLEAR_SHARE else f"({text})"


def _findings(data_quality: DataQuality) -> list[Block]:
    blocks: list[Block] = []
    for finding in data_quality.findings:
        words = f"{finding.severity}: {finding.message}; {finding.remedy}"
        note = Note(words, finding.code, state=SEVERITY_STATES[finding.severity])
        blocks.append(Notes((note,)))
        if finding.lines:
            blocks.append(Code("\n".join(finding.lines), title=QUALITY_NOTE))
    return blocks


def _of_predicted(found: Identified) -> list[Block]:
    """Findings of the recordings that are predicted and not fitted."""
    blocks: list[Block] = []
    for name, data_quality in zip(found.predicted_recordings, found.validation_data_quality, strict=True):
        if data_quality is None:
            blocks.append(Prose(f"{name}, which is predicted, is too short to be examined."))
        elif data_quality.findings:
            blocks += [Prose(f"Of {name}, which is predicted:"), *_findings(data_quality)]
    return blocks


def excitation_table(model: IdentifiedModel) -> Table:
    rows = tuple(
        Row((group.name, f"{group.determined} of {group.structural}", group.weakest))
        for group in excitation(model.problem)
        if group.structural
    )
    return Table(
        (
            Column("parameters", "name"),
            Column("determined", "number", meaning="base parameters, of those that any motion could determine"),
            Column("excitation", "number", form=".2g"),
        ),
        rows,
        caption="excitation: smallest singular value of the part of the regressor that no other group can imitate, "
        "joints weighted by their torque, columns at unit length; 1 is best",
    )


def rejection_sections(found: Identified) -> tuple[Section, ...]:
    """Why no result is recommended, joint by joint; none where one is."""
    notes = tuple(Note(words, state="disagrees") for words in found.recommendation.rejection_reasons)
    return (Section("rejection_reasons", "Why no model is recommended", (Notes(notes),)),) if notes else ()
