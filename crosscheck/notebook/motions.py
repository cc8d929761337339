"""Motions and recordings: what they are of, and their curves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.recordings import Recording
from crosscheck.report.report import Block, Column, Facts, Note, Notes, Panel, Plot, Report, Row, Section, Series, Table
from crosscheck.report.robot_parts import robot_picture
from graphdyn import Simulation, VirtualRecording
from graphdyn.errors import counted
from graphdyn.layout import Array

DRAWN_CHANNELS = {"q": "positions q", "v": "velocities v", "a": "accelerations a", "tau": "torques τ"}
"""Channels that are drawn, with the titles of their panels."""

CHANNEL_UNITS = {"q": ("rad", "m"), "v": ("rad/s", "m/s"), "a": ("rad/s²", "m/s²"), "tau": ("N m", "N")}
"""Units of every channel, at joints that turn and at those that slide."""


def motion_report(motion: Simulation) -> Report:
    """A simulated motion: the robot, the largest values of every joint, positions and torques over time."""
    lasted = f"{motion.time[-1]:g} s, {counted(len(motion.time), 'row')}"
    ended = f"; ended by: {motion.ended}" if motion.ended else ""
    columns = (motion.q.min(axis=0), motion.q.max(axis=0), np.abs(motion.v).max(axis=0), np.abs(motion.tau).max(axis=0))
    joints = Table(
        (
            Column("joint", "name"),
            Column("q from", "number", form=".4g", meaning="rad or m"),
            Column("to", "number", form=".4g", meaning="rad or m"),
            Column("|v|", "number", form=".4g", meaning="largest [rad/s or m/s]"),
            Column("|τ|", "number", form=".4g", meaning="largest of the actuator [N m or N]"),
        ),
        tuple(Row(cells) for cells in zip(motion.joint_names, *columns, strict=True)),
        failures_first=False,
    )
    moving = {joint.name: joint.is_prismatic for joint in motion.model.joints}
    slides = [moving[name] for name in motion.joint_names]
    curves = _curves(motion.joint_names, slides, motion.time, {"q": motion.q, "tau": motion.tau})
    blocks = (robot_picture(motion.model, motion.model.name), Facts((("time", lasted + ended),)), joints, curves)
    return Report(f"{motion.model.name}, simulated", None, (Section("motion", "", blocks),))


def recording_overview(recording: Recording) -> Report:
    """A recording: rows and channels, what was found in it, its curves."""
    files = ", ".join(recording.provenance.files) or "recording"
    blocks = counted(len(recording.block_slices), "block")
    facts = (
        ("rows", f"{len(recording.t)} in {blocks}, {recording.t[0]:g} to {recording.t[-1]:g} s"),
        ("joints", ", ".join(recording.joint_names)),
        *(("" if k else "prepared", step) for k, step in enumerate(recording.provenance.steps)),
    )
    notes = tuple(Note(finding.message, finding.code) for finding in recording.findings)
    t = np.maximum.accumulate(recording.t)
    channels = {name: recording.channel(name) for name in recording.recorded(tuple(DRAWN_CHANNELS))}
    return _overview(files, facts, (Notes(notes), _curves(recording.joint_names, recording.prismatic, t, channels)))


def virtual_recording_overview(recording: VirtualRecording) -> Report:
    """A virtual recording: rows, and the curves of the joints."""
    facts = (
        ("rows", f"{len(recording.time)}, {recording.time[0]:g} to {recording.time[-1]:g} s"),
        ("joints", ", ".join(recording.joint_names)),
    )
    channels = {name: getattr(recording, name) for name in ("q", "v", "tau")}
    curves = _curves(recording.joint_names, recording.prismatic, recording.time, channels)
    return _overview(f"{recording.robot}, virtual recording", facts, (curves,))


def _overview(title: str, facts: tuple[tuple[str, str], ...], blocks: Sequence[Block]) -> Report:
    return Report(title, None, (Section("recording", "", (Facts(facts), *blocks)),))


def _curves(joints: Sequence[str], slides: Sequence[bool], t: Array, channels: dict[str, Array]) -> Plot:
    """A panel for every channel; slides: which joints do."""
    panels = tuple(
        Panel(
            DRAWN_CHANNELS[name],
            tuple(Series(joint, values[:, j], color=j) for j, joint in enumerate(joints)),
            " or ".join(CHANNEL_UNITS[name][sliding] for sliding in sorted(set(slides))),
        )
        for name, values in channels.items()
    )
    titles = ", ".join(DRAWN_CHANNELS[name] for name in channels)
    return Plot(t, "t [s]", panels, f"{titles} of {', '.join(joints)} over time", on=("page",))
