"""`graphdyn simulate`: a motion and its loads, as a report."""

from __future__ import annotations

from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.commands.simulate.record import SimulatedRun, of_all_joints, record
from crosscheck.report.report import Block, Column, Facts, Group, Panel, Plot, Report, Row, Section, Series, Table
from crosscheck.report.robot_parts import reading_text, robot_picture
from graphdyn import RobotModel, Simulation
from graphdyn.errors import counted
from graphdyn.layout import Array

MAX_SHOWN_ROWS = 2000
"""Rows of a curve at most: more would be invisible."""


def simulate_report(run: SimulatedRun) -> Report:
    name, motion, model = Path(run.robot).name, run.motion, run.motion.model
    return Report(
        f"{name}, simulated",
        None,
        (
            Section("motion", "", (*_overview(run, model), _loads(run))),
            Section("curves", "Curves", (_curves(motion),)),
        ),
        record=partial(record, run),
    )


def _overview(run: SimulatedRun, model: RobotModel) -> tuple[Block, ...]:
    motion, name = run.motion, Path(run.robot).name
    energy = motion.energy
    lasted = f"{motion.time[-1]:g} s, {counted(len(motion.time), 'row')}"
    steps = f"steps of {run.step:g} s" if run.step else "steps that adapt"
    facts = [
        ("robot", f"{run.robot}: {counted(model.n_bodies, 'joint')}{reading_text(run.locked, run.chain)}"),
        ("time", f"{lasted}; ended by: {motion.ended}" if motion.ended else lasted),
        ("method", f"{run.method}, {steps}"),
        ("torque", run.torque),
        ("energy drift", f"{energy.drift:.1e} of the largest kinetic energy, {energy.kinetic.max():.4g} J"),
        ("closure", f"{_what_closes(model)} closed to {motion.closure_error().max():.1e} (m, cosines)"),
    ]
    if run.out:
        facts.append(("written to", run.out))
    return robot_picture(model, name), Group((Facts(tuple(facts)),))


def _what_closes(model: RobotModel) -> str:
    return "joints and loops" if model.chords else "joints"


def _loads(run: SimulatedRun) -> Table:
    number: dict[str, Any] = {"kind": "number", "form": ".4g"}
    loads = ("largest_velocity", "largest_torque", "largest_force", "largest_moment")
    cells = attrgetter("number", "name", "lowest", "highest", *loads)
    return Table(
        (
            Column("no.", "number"),
            Column("joint", "name"),
            Column("q from", unit="rad or m", **number),
            Column("to", unit="rad or m", **number),
            Column("|v|", unit="…/s", **number),
            Column("|τ|", unit="N m or N", meaning="of the actuator", **number),
            Column("force", unit="N", meaning="that the joint transmits", **number),
            Column("moment", unit="N m", meaning="about the joint, that of the actuator included", **number),
        ),
        tuple(Row(cells(joint)) for joint in run.joints),
        title="Joints, and their largest speeds and loads",
        failures_first=False,
        repeated=2,
    )


def _curves(motion: Simulation) -> Plot:
    rows = np.unique(np.linspace(0, len(motion.time) - 1, min(MAX_SHOWN_ROWS, len(motion.time))).astype(int))
    energy, (q, v, tau) = motion.energy, of_all_joints(motion)

    def series(values: Array) -> tuple[Series, ...]:
        return tuple(Series(name, values[rows, j], color=j) for j, name in enumerate(motion.model.joint_names))

    energies = (
        Series("kinetic", energy.kinetic[rows], color=0),
        Series("potential", energy.potential[rows], color=1),
        Series("work of the actuators", energy.work[rows], color=2),
        Series("dissipated by friction and stops", energy.loss[rows], color=3),
    )
    return Plot(
        motion.time[rows],
        "t [s]",
        (
            Panel("position", series(q), "rad or m"),
            Panel("velocity", series(v), "rad/s or m/s"),
            Panel("torque of the actuators", series(tau), "N m or N"),
            Panel("energy", energies, "J"),
        ),
        f"Positions, velocities, torques and energies of {motion.model.name} over {motion.time[-1]:g} s",
        on=("page",),
    )
