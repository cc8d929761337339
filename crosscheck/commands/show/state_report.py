"""The section of `graphdyn show` on one state of the robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from crosscheck.commands.show.describing_state import ENERGY_VERBS
from crosscheck.commands.show.description import FrameStateDescription, MassMotionDescription, StateDescription
from crosscheck.report.plain_text import ZERO_COMPONENT_SHARE, vector_text
from crosscheck.report.report import Column, Facts, Group, Row, Section, Table
from graphdyn import RobotModel
from graphdyn.layout import Array

JACOBIAN_ROWS = ("v_x", "v_y", "v_z", "ω_x", "ω_y", "ω_z")
"""Rows of a frame Jacobian."""


ZERO_ENERGY = {"potential_energy": ", zero at the height of the world's origin"}
"""Positions at which energies without a natural zero are zero."""


def state_section(state: StateDescription, model: RobotModel) -> Section:
    facts = Facts(
        (
            *(
                (name.replace("_", " "), f"{getattr(state, name):.6g} J{ZERO_ENERGY.get(name, '')}")
                for name in ENERGY_VERBS
            ),
            *([] if state.motion is None else _motion(state.motion)),
        )
    )
    return Section("state", "State", (facts, _joints(state, model), _bodies(state), _frame(state.frame), _mass(state)))


def _motion(motion: MassMotionDescription) -> Iterator[tuple[str, str]]:
    yield "center of mass", f"{vector_text(motion.center_of_mass)} m in the world"
    yield "its velocity", f"{vector_text(motion.center_of_mass_velocity)} m/s"
    yield "momentum", f"{vector_text(motion.momentum[:3])} kg m/s"
    yield "angular momentum", f"{vector_text(motion.momentum[3:])} kg m²/s about the center of mass"
    yield "", f"{vector_text(motion.momentum_about_origin[3:])} kg m²/s about the world's origin"


def _joints(state: StateDescription, model: RobotModel) -> Table:
    unknown = [None] * len(state.q)
    columns = state.q, state.v, state.gravity_torque or unknown, state.bias_torque or unknown
    rows = np.transpose([_without_rounding(values) for values in columns])
    return Table(
        (
            Column("no.", "number"),
            Column("joint", "name"),
            Column("q", "number", form=".6g"),
            Column("v", "number", form=".6g"),
            Column("gravity torque", "number", form=".6g", meaning="what holds the robot at rest"),
            Column("bias torque", "number", form=".6g", meaning="h in M a + h = τ: gravity and velocities"),
        ),
        tuple(
            Row((number, name, *values))
            for number, (name, values) in enumerate(zip(model.independent_joints, rows.tolist(), strict=True), start=1)
        ),
        caption="rad or m, …/s, N m or N" + (", of the motors" if model.chords else ""),
        repeated=2,
    )


def _bodies(state: StateDescription) -> Table:
    return Table(
        (
            Column("no.", "number"),
            Column("body", "name"),
            Column("xyz", "vector", "m", vector_text),
            Column("rpy", "vector", "°", vector_text),
        ),
        tuple(Row((number, body.name, body.xyz, body.rpy)) for number, body in enumerate(state.bodies, start=1)),
        title="Link frames in the world",
    )


def _frame(frame: FrameStateDescription) -> Group:
    facts = Facts(
        (
            ("in the world", f"at {vector_text(frame.xyz)} m, rpy {vector_text(frame.rpy)}°"),
            ("velocity", f"{vector_text(frame.velocity[:3])} m/s, {vector_text(frame.velocity[3:])} rad/s"),
        ),
        title=f"Frame '{frame.name}'",
    )
    return Group(
        (facts, _matrix(frame.jacobian, f"Jacobian, {frame.reference}", "m; 1 of revolute joints", JACOBIAN_ROWS))
    )


def _mass(state: StateDescription) -> Table:
    numbers = [str(number) for number in range(1, len(state.q) + 1)]
    condition = Column("", form=".4g").text(state.mass_matrix_condition)
    return _matrix(state.mass_matrix, f"Mass matrix, condition number {condition}", "kg m², kg m, kg", numbers)


def _matrix(matrix: Sequence[Sequence[float]], title: str, units: str, rows: Sequence[str]) -> Table:
    """A column for each joint, by number."""
    return Table(
        (Column(""), *(Column(str(number), "number", form=".4g") for number in range(1, len(matrix[0]) + 1))),
        tuple(Row((name, *row)) for name, row in zip(rows, _without_rounding(matrix).tolist(), strict=True)),
        title=title,
        caption=f"[{units}]; joints by number",
        compact=True,
    )


def _without_rounding(values: Sequence[float | None] | Sequence[Sequence[float]]) -> Array:
    """What is smaller than ROUNDING of the largest entry is 0; None is NaN."""
    array = np.array(values, dtype=float)
    return np.where(np.abs(array) <= ZERO_COMPONENT_SHARE * np.abs(array).max(initial=0.0), 0.0, array)
