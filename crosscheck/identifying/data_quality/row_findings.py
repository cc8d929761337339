"""Findings on the rows of a recording that need no model: held values, repeated rows, the clock."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from crosscheck.identifying.data_quality.finding import QualityFinding
from crosscheck.recordings import Recording
from graphdyn.errors import counted
from graphdyn.identification.data_quality import HeldValues, RecordingQuality, common_rate, held_values

MIN_REPEATED_SHARE = 0.02
"""Share of rows that repeat others from which a recording is at fault."""

MIN_CLOCK_ERROR = 0.03
"""Common ratio of velocities to rates of positions, less 1, from which the clock is wrong."""

MAX_MODEL_RESIDUAL = 1.5e-3
"""Residual of CAD with drives, relative to the torque, up to which all torques are the output of a model."""

MAX_STEP_SHARE = 1.5
"""Step between rows, relative to the usual one, from which rows between them were left out."""


def held_rows(recordings: Sequence[Recording]) -> list[HeldValues]:
    """Held values of recordings as they were read, block by block."""
    found = []
    for recording in recordings:
        for rows in recording.block_slices:
            v = None if recording.v is None else recording.v[rows]
            found.append(held_values(recording.q[rows], recording.channel("tau")[rows], v))
    return found


def measured_parts(recordings: Sequence[Recording], held: Sequence[HeldValues]) -> list[Recording]:
    """The recordings without rows that hold a value, in blocks between them and between gaps. held: as of held_rows"""
    left, blocks = [], iter(held)
    for recording in recordings:
        own = [next(blocks) for _ in recording.block_slices]
        measured = np.concatenate([block.measured for block in own])
        gaps = [rows.start + block.gaps for rows, block in zip(recording.block_slices, own, strict=True)]
        piece = recording.block + np.cumsum(np.isin(np.arange(len(recording.t)) - 1, np.concatenate(gaps)))
        if not measured.any():
            continue
        part = recording.take(measured, block=piece[measured])
        steps, same = np.diff(part.t), np.diff(part.block) == 0
        usual = np.median(steps[same]) if same.any() else np.inf
        new = ~same | (steps > MAX_STEP_SHARE * usual)
        unchanged = measured.all() and not np.concatenate(gaps).size
        left.append(recording if unchanged else replace(part, block=np.concatenate([[0], np.cumsum(new)])))
    return left


def held_findings(held: Sequence[HeldValues], names: tuple[str, ...]) -> Iterator[QualityFinding]:
    """Dead channels, clipped positions and repeated rows. held: as of held_rows; names: of the joints"""
    repeated = float(np.mean(np.concatenate([part.repeated for part in held])))
    if repeated > MIN_REPEATED_SHARE:
        message = f"{100 * repeated:.0f} % of the rows repeat other rows exactly while the robot moves"
        remedy = "record each sample once: drop the copies, or give the rate at which the robot sends"
        yield QualityFinding("repeated-rows", "fault", names, message, remedy)
    if gaps := sum(len(part.gaps) for part in held):
        message = f"all positions jump at once {counted(gaps, 'time')}: rows are missing there, and the times hide it"
        remedy = "give the robot's own time stamps, or use the parts between the jumps, by --split"
        yield QualityFinding("missing-rows", "fault", names, message, remedy)
    torque, position, clipped = (
        np.concatenate([getattr(part, what) for part in held]).mean(axis=0)
        for what in ("dead_torques", "dead_positions", "clipped_positions")
    )
    for j, name in enumerate(names):
        for what, share in (("torque", torque[j]), ("position", position[j])):
            if share > 0:
                message = (
                    f"the {what} of {name} holds one value in {100 * share:.2g} % of the rows while the joint moves"
                )
                remedy = "the channel was dead there: use another part, by --split"
                yield QualityFinding("dead-channel", "fault", (name,), message, remedy)
        if clipped[j] > 0:
            message = f"the position of {name} is held at an end of its range in {100 * clipped[j]:.2g} % of the rows"
            remedy = "the sensor stops there while the joint moves on: use another part, by --split"
            yield QualityFinding("clipped-position", "fault", (name,), message, remedy)


def model_findings(found: RecordingQuality) -> Iterator[QualityFinding]:
    """Torques without any error of measurement: the output of CAD, or of one joint that of some model."""
    if found.channels.constant_torques or found.channels.duplicated_torques:
        return  # these have findings of their own
    cad = found.gains.without_gain
    if len(cad) > 1 and np.all(cad <= MAX_MODEL_RESIDUAL):
        message = f"the torques are those of CAD with drives, to {100 * cad.max():.2g} %: the output of a model"
        remedy = "name the columns that were measured; of a simulation, identify with links that differ from its own"
        yield QualityFinding("model-torque", "fault", found.joint_names, message, remedy)
        return
    for j in found.modeled:
        own = min(float(cad[j]), float(found.errors[j]))
        message = (
            f"the torque of {found.joint_names[j]} has no error of measurement ({100 * own:.2g} %, the others "
            f"{100 * np.median(np.delete(found.errors, found.modeled)):.2g} %): the output of a model"
        )
        yield QualityFinding(
            "model-torque", "fault", (found.joint_names[j],), message, "name the column that was measured"
        )


def clock_rate(found: RecordingQuality) -> float:
    """Common ratio of velocities to rates of positions; NaN if the clock is right, or the joints do not agree on it."""
    rate = common_rate(found.channels.velocity_gain)
    return rate if abs(rate - 1) > MIN_CLOCK_ERROR else float("nan")


def clock_findings(found: RecordingQuality) -> Iterator[QualityFinding]:
    """The clock, if velocities of their own show that it is wrong."""
    rate = clock_rate(found)
    if np.isfinite(rate):
        message = (
            f"all velocities are {rate:.4g} times the rates of the positions: the time stamps are {rate:.4g} times too "
            "close, or the unit of velocities is another one"
        )
        remedy = "correct the clock, or the unit of [v]"
        yield QualityFinding("time-scale", "fault", found.joint_names, message, remedy)
