"""`graphdyn simulate`: a motion and its loads, as a report."""

from __future__ import annotations

from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.commands.simulate.record import SimulatedRun, of_all_joints, record
from crosscheck.report.report import (
    Block,
    Column,
    Facts,
    Group,
    Note,
    Notes,
    Panel,
    Plot,
    Report,
    Row,
    Section,
    Series,
    Table,
)
from crosscheck.report.robot_parts import reading_text, robot_picture
from graphdyn import RobotModel, Simulation
from graphdyn.errors import counted
from graphdyn.layout import Array
from graphdyn.model import unit_of

MAX_SHOWN_ROWS = 2000
"""Rows of a curve at most: more would be invisible."""


def simulate_report(run: SimulatedRun) -> Report:
    name, motion, model = Path(run.robot).name, run.motion, run.motion.model
    return Report(
        f"{name}, simulated",
        None,
        (
            Section("motion", "", (*_overview(run, model), _passed(run), _loads(run))),
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


LIMIT_UNITS = {"position": ("rad", "m"), "velocity": ("rad/s", "m/s"), "effort": ("N m", "N")}
"""Units of each kind of limit: of a joint that turns, of one that slides."""


def _passed(run: SimulatedRun) -> Notes:
    """The limits of the file that the motion passes."""
    notes = []
    for one in run.passed_limits:
        unit = LIMIT_UNITS[one.kind][one.prismatic]
        reached = f"its {one.kind} reaches {one.farthest:.4g} {unit}"
        passed = f"it passes the limit of {one.limit:.4g} {unit} at {one.time:.4g} s"
        notes.append(Note(f"{reached}; {passed}", where=one.joint, state="undecided"))
    return Notes(tuple(notes), title="Limits that the motion passes")


def _what_closes(model: RobotModel) -> str:
    return "joints and loops" if model.chords else "joints"


def _loads(run: SimulatedRun) -> Table:
    unit = partial(unit_of, run.motion.model.joints)
    number: dict[str, Any] = {"kind": "number", "form": ".4g"}
    loads = ("largest_velocity", "largest_torque", "largest_force", "largest_moment")
    cells = attrgetter("number", "name", "lowest", "highest", *loads)
    return Table(
        (
            Column("no.", "number"),
            Column("joint", "name"),
            Column("q from", unit=unit("rad", "m"), **number),
            Column("to", unit=unit("rad", "m"), **number),
            Column("|v|", unit=unit("rad/s", "m/s"), **number),
            Column("|τ|", unit=unit("N m", "N"), meaning="of the actuator", **number),
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
    energy, (q, v, tau), unit = motion.energy, of_all_joints(motion), partial(unit_of, motion.model.joints)

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
            Panel("position", series(q), unit("rad", "m")),
            Panel("velocity", series(v), unit("rad/s", "m/s")),
            Panel("torque of the actuators", series(tau), unit("N m", "N")),
            Panel("energy", energies, "J"),
        ),
        f"Positions, velocities, torques and energies of {motion.model.name} over {motion.time[-1]:g} s",
        on=("page",),
    )
