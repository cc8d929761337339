"""What `graphdyn show` says of one state of a robot."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import graphdyn
from crosscheck.commands.show.description import (
    BodyPlacementDescription,
    FrameStateDescription,
    MassMotionDescription,
    StateDescription,
)
from graphdyn import (
    InvalidInput,
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


def describe_state(model: RobotModel, q: Array, v: Array, frame: str, reference: Reference) -> StateDescription:
    """What the robot is like at q, v (n,).

    Raises UnknownFrame; InvalidInput for an unknown reference; InconsistentState, naming the loop, where q is open or v
    opens it.
    """
    if model.chords:
        closed(model, q, v)
    mass = mass_matrix(model, q)
    return StateDescription(
        q=q.tolist(),
        v=v.tolist(),
        **{name: float(getattr(graphdyn, name)(model, *(q, v)[: len(VERBS[name].inputs)])) for name in ENERGY_VERBS},
        motion=_motion(model, q, v) if any(body.mass for body in model.bodies) else None,
        gravity_torque=_at_motors(model, lambda: gravity_torque(model, q)),
        bias_torque=_at_motors(model, lambda: bias_torque(model, q, v)),
        mass_matrix=mass.tolist(),
        mass_matrix_condition=float(np.linalg.cond(mass)),
        bodies=_bodies(model, q),
        frame=_frame(model, q, v, frame, reference),
    )


def _at_motors(model: RobotModel, torque: Callable[[], Array]) -> list[float] | None:
    """None where the motors of a robot with loops are unknown or leave a motion free."""
    try:
        return torque().tolist()  # type: ignore[no-any-return]
    except InvalidInput:
        if not model.chords:
            raise
        return None


def _motion(model: RobotModel, q: Array, v: Array) -> MassMotionDescription:
    found = momentum(model, q, v)
    return MassMotionDescription(
        center_of_mass=center_of_mass(model, q).tolist(),
        center_of_mass_velocity=center_of_mass_velocity(model, q, v).tolist(),
        momentum=found.about_center_of_mass.tolist(),
        momentum_about_origin=found.about_origin.tolist(),
    )


def _bodies(model: RobotModel, q: Array) -> list[BodyPlacementDescription]:
    state = maximal_state(model, q)
    return [
        BodyPlacementDescription(name=name, xyz=xyz.tolist(), rpy=np.rad2deg(rpy_from_rotation(rotation)).tolist())
        for name, xyz, rotation in zip(model.body_names, link_origins(state), state.rotation, strict=True)
    ]


def _frame(model: RobotModel, q: Array, v: Array, name: str, reference: Reference) -> FrameStateDescription:
    rotation, position = frame_placement(model, q, name)
    return FrameStateDescription(
        name=name,
        reference=reference,
        xyz=position.tolist(),
        rpy=np.rad2deg(rpy_from_rotation(rotation)).tolist(),
        velocity=frame_velocity(model, q, v, name, reference=reference).tolist(),
        jacobian=frame_jacobian(model, q, name, reference=reference).tolist(),
    )
