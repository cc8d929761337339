"""One state of a robot: what `graphdyn show` computes, and the section that says it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

import graphdyn
from crosscheck.report.plain_text import ZERO_COMPONENT_SHARE, vector_text
from crosscheck.report.report import Column, Facts, Group, Row, Section, Table
from crosscheck.report.robot_parts import joint_units
from graphdyn import (
    InvalidInput,
    Placement,
    RobotModel,
    bias_torque,
    center_of_mass,
    center_of_mass_velocity,
    frame_jacobian,
    frame_placement,
    frame_velocity,
    gravity_torque,
    mass_matrix,
    maximal_state,
    momentum,
)
from graphdyn.arguments import Reference
from graphdyn.equations import closed, link_origins
from graphdyn.layout import Array
from graphdyn.recursions import ARRAY_SPECS
from graphdyn.verbs import VERBS
from urdf.document import rpy_from_rotation

ENERGY_VERBS = tuple(name for name, array in ARRAY_SPECS.items() if array.unit == "J" and name in VERBS)
"""Verbs that answer an energy, of q, or of q and v."""

JACOBIAN_ROWS = ("v_x", "v_y", "v_z", "ω_x", "ω_y", "ω_z")
"""Rows of a frame Jacobian."""

ZERO_ENERGY = {"potential_energy": ", zero at the height of the world's origin"}
"""Positions at which energies without a natural zero are zero."""


@dataclass(frozen=True, eq=False)
class PlacedDescription:
    """The placement of a frame, by its name.

    name: of the link or frame
    xyz: its origin (3,) [m]
    rpy: roll, pitch, yaw, R = R_z(yaw) R_y(pitch) R_x(roll) (3,) [degree]
    """

    name: str
    xyz: Array
    rpy: Array


@dataclass(frozen=True, eq=False)
class MassMotionDescription:
    """Center of mass and momentum of all moving bodies together, in world axes.

    center_of_mass: in the world (3,) [m]
    center_of_mass_velocity: (3,) [m/s]
    momentum: linear, then angular about the center of mass (6,) [kg m/s, kg m²/s]
    momentum_about_origin: linear, then angular about the world's origin (6,) [kg m/s, kg m²/s]
    """

    center_of_mass: Array
    center_of_mass_velocity: Array
    momentum: Array
    momentum_about_origin: Array


@dataclass(frozen=True, eq=False)
class FrameStateDescription(PlacedDescription):
    """Placement in the world and motion of a named frame.

    reference: point and axes of velocity and Jacobian, in Pinocchio's words
    velocity: linear velocity, then angular velocity (6,) [m/s, rad/s]
    jacobian: J with velocity = J v (6, n) [m, 1 of revolute joints, 1, 0 of prismatic ones]
    """

    reference: Reference
    velocity: Array
    jacobian: Array


@dataclass(frozen=True, eq=False)
class StateDescription:
    """The robot at one state.

    q: joint positions (n,) [rad or m]
    v: joint velocities (n,) [rad/s or m/s]
    kinetic_energy: [J]
    potential_energy: zero where the centers of mass are at the height of the world's origin [J]
    motion: of the whole robot; None where no body has mass
    gravity_torque: what holds the robot at rest; with loops, at the motors, and None where these are unknown or leave a
        motion free (n,) [N m or N]
    bias_torque: h in M a + h = τ; with loops as gravity_torque (n,) [N m or N]
    mass_matrix: M; of a robot with loops, of the tree, whose joints are free (n, n) [kg m², kg m, kg]
    mass_matrix_condition: 2-norm condition number of M in SI units; may be ∞
    bodies: where the link frames are in the world
    frame: where a named frame is, and how it moves
    """

    q: Array
    v: Array
    kinetic_energy: float
    potential_energy: float
    motion: MassMotionDescription | None
    gravity_torque: Array | None
    bias_torque: Array | None
    mass_matrix: Array
    mass_matrix_condition: float
    bodies: Sequence[PlacedDescription]
    frame: FrameStateDescription


def rpy_in_degrees(placement: Placement) -> Array:
    """Roll, pitch, yaw (3,) [degree]."""
    return np.rad2deg(rpy_from_rotation(placement.rotation))


def describe_state(model: RobotModel, q: Array, v: Array, frame: str, reference: Reference) -> StateDescription:
    """What the robot is like at q, v (n,).

    Raises UnknownFrame; InvalidInput for an unknown reference; InconsistentState, naming the loop, where q is open or v
    opens it.
    """
    if model.chords:
        closed(model, q, v)
    mass, state = mass_matrix(model, q), maximal_state(model, q)
    return StateDescription(
        q=q,
        v=v,
        **{name: float(getattr(graphdyn, name)(model, *(q, v)[: len(VERBS[name].inputs)])) for name in ENERGY_VERBS},
        motion=_motion(model, q, v) if any(body.mass for body in model.bodies) else None,
        gravity_torque=_at_motors(model, lambda: gravity_torque(model, q)),
        bias_torque=_at_motors(model, lambda: bias_torque(model, q, v)),
        mass_matrix=mass,
        mass_matrix_condition=float(np.linalg.cond(mass)),
        bodies=[
            PlacedDescription(name, xyz, np.rad2deg(rpy_from_rotation(rotation)))
            for name, xyz, rotation in zip(model.body_names, link_origins(state), state.rotation, strict=True)
        ],
        frame=_frame(model, q, v, frame, reference),
    )


def _at_motors(model: RobotModel, torque: Callable[[], Array]) -> Array | None:
    """None where the motors of a robot with loops are unknown or leave a motion free."""
    try:
        return torque()
    except InvalidInput:
        if not model.chords:
            raise
        return None


def _motion(model: RobotModel, q: Array, v: Array) -> MassMotionDescription:
    found = momentum(model, q, v)
    return MassMotionDescription(
        center_of_mass(model, q), center_of_mass_velocity(model, q, v), found.about_center_of_mass, found.about_origin
    )


def _frame(model: RobotModel, q: Array, v: Array, name: str, reference: Reference) -> FrameStateDescription:
    rotation, position = frame_placement(model, q, name)
    return FrameStateDescription(
        name,
        position,
        np.rad2deg(rpy_from_rotation(rotation)),
        reference,
        frame_velocity(model, q, v, name, reference=reference),
        frame_jacobian(model, q, name, reference=reference),
    )


def state_section(state: StateDescription, model: RobotModel) -> Section:
    facts = Facts(
        (
            *(
                (name.replace("_", " "), f"{getattr(state, name):.6g} J{ZERO_ENERGY.get(name, '')}")
                for name in ENERGY_VERBS
            ),
            *([] if state.motion is None else _motion_facts(state.motion)),
        )
    )
    return Section(
        "state", "State", (facts, _joints(state, model), _bodies(state), _frame_group(state.frame), _mass(state))
    )


def _motion_facts(motion: MassMotionDescription) -> Iterator[tuple[str, str]]:
    yield "center of mass", f"{vector_text(motion.center_of_mass)} m in the world"
    yield "its velocity", f"{vector_text(motion.center_of_mass_velocity)} m/s"
    yield "momentum", f"{vector_text(motion.momentum[:3])} kg m/s"
    yield "angular momentum", f"{vector_text(motion.momentum[3:])} kg m²/s about the center of mass"
    yield "", f"{vector_text(motion.momentum_about_origin[3:])} kg m²/s about the world's origin"


def _joints(state: StateDescription, model: RobotModel) -> Table:
    torques = [
        np.full(len(state.q), np.nan) if tau is None else tau for tau in (state.gravity_torque, state.bias_torque)
    ]
    rows = np.transpose([_without_rounding(values) for values in (state.q, state.v, *torques)])
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
        caption=joint_units(model) + (", of the motors" if model.chords else ""),
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


def _frame_group(frame: FrameStateDescription) -> Group:
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


def _matrix(matrix: Array, title: str, units: str, rows: Sequence[str]) -> Table:
    """A column for each joint, by number."""
    return Table(
        (Column(""), *(Column(str(number), "number", form=".4g") for number in range(1, len(matrix[0]) + 1))),
        tuple(Row((name, *row)) for name, row in zip(rows, _without_rounding(matrix).tolist(), strict=True)),
        title=title,
        caption=f"[{units}]; joints by number",
        compact=True,
    )


def _without_rounding(values: Array) -> Array:
    """What is smaller than ZERO_COMPONENT_SHARE of the largest entry is 0."""
    return np.where(np.abs(values) <= ZERO_COMPONENT_SHARE * np.abs(values).max(initial=0.0), 0.0, values)
