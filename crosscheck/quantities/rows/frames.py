"""Placements and motions of a frame of the robot."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypedDict

import numpy as np

import graphdyn
from crosscheck.quantities.measures import ORDER, Chosen, Measure, linear_first
from crosscheck.quantities.quantity import USUAL, Ours, Quantity, frame_verb
from crosscheck.quantities.rows.dynamics import PLACED, placement_errors
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import Sizes, by_part
from crosscheck.quantities.tested_function import TestedFunction
from crosscheck.reference.native_functions import FrameFunction
from crosscheck.reference.subject import compared_frames, placed_frames
from graphdyn.arguments import Method
from graphdyn.layout import Array

if TYPE_CHECKING:
    from crosscheck.reference.pinocchio_model import PinocchioAnswers

_BY_REFERENCE = {"reference": ("local_world_aligned", "world", "local"), **ORDER}
"""Choices of the axes and the point of a twist: at the frame in world axes, at the world's origin, at the frame."""

VELOCITY = "linear: ‖ω‖ × lever + slide rate"


def _homogeneous(rotation: Array, position: Array) -> Array:
    """[[R, p], [0, 1]] (…, 4, 4) from R (…, 3, 3) and p (…, 3)."""
    placed = np.zeros((*position.shape[:-1], 4, 4))
    placed[..., :3, :3], placed[..., :3, 3], placed[..., 3, 3] = rotation, position, 1.0
    return placed


def _placement(states: ScaledStates, chosen: Chosen, method: Method) -> Array:
    """Placement of the frame of the states, or of all that are compared (N, m, 4, 4)."""
    model, q = states.model, states.q
    if states.frame is not None:
        return _homogeneous(*graphdyn.frame_placement(model, q, states.frame))
    return np.stack([_homogeneous(*graphdyn.frame_placement(model, q, name)) for name in placed_frames(model)], axis=1)


def _placement_of_pinocchio(there: PinocchioAnswers, chosen: Chosen) -> Array:
    names = [there.frame] if there.frame else placed_frames(there.robot.model)
    placed = _homogeneous(*there.robot.frame_placements(there.q, names))
    return placed[:, 0] if there.frame else placed


def _by_part(linear: Callable[[Sizes], Array], angular: Callable[[Sizes], Array], six: int = -1) -> Measure:
    """Errors of linear and angular parts, each on its own scale, of points as far away as the chosen reference has
    them.

    six: the axis of the two parts
    """

    def errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
        model = states.model
        names = [states.frame] if states.frame is not None else compared_frames(model)
        at_frames = [model.frame(name).placement.translation for name in names]
        points = [model.base.translation] if chosen["reference"] == "world" else at_frames
        there = states.sizes.farther(max(float(np.abs(point).max()) for point in points))
        x, y = (np.moveaxis(linear_first(z, chosen, six), six, -1) for z in (x, y))
        return by_part(x, y, linear(there), angular(there))

    return errors


_ACCELERATION = "linear: swing; angular: turn"
_acceleration_errors = _by_part(lambda size: size.acceleration, lambda size: size.turn)


class FrameFunctions(TypedDict, total=False):
    """What of it a user may give to be judged, as keywords of crosscheck.judge."""

    frame_placement: TestedFunction | None
    frame_jacobian: TestedFunction | None
    frame_jacobian_derivative: TestedFunction | None
    frame_velocity: TestedFunction | None
    frame_acceleration: TestedFunction | None


FRAMES = (
    Quantity(
        name="frame_placement",
        ours=Ours(
            ("q",), (4, 4), "m", _placement,
            "np.vstack([np.column_stack(graphdyn.frame_placement(model, q, {frame!r})), [0, 0, 0, 1]])",
        ),
        pinocchio=_placement_of_pinocchio,
        against="updateFramePlacements, oMf of fused links",
        errors=placement_errors,
        scale=PLACED,
        forms=USUAL,
        of_frame=True,
        from_file=True,
    ),
    Quantity(
        name="frame_jacobian",
        ours=frame_verb("frame_jacobian"),
        pinocchio=FrameFunction("getFrameJacobian", alone="computeFrameJacobian"),
        errors=_by_part(lambda size: size.arm, lambda size: np.ones_like(size.arm), -2),
        scale="linear: arm; angular: 1",
        of_frame=True,
        conventions=_BY_REFERENCE,
        six=-2,
        benchmark="frame Jacobian",
    ),
    Quantity(
        name="frame_jacobian_derivative",
        ours=frame_verb("frame_jacobian_derivative"),
        pinocchio=FrameFunction("getFrameJacobianTimeVariation"),
        errors=_by_part(lambda size: size.omega * size.arm + size.slide_rate, lambda size: size.omega, -2),
        scale="linear: rate; angular: ‖ω‖",
        of_frame=True,
        conventions=_BY_REFERENCE,
        six=-2,
    ),
    Quantity(
        name="frame_velocity",
        ours=frame_verb("frame_velocity"),
        pinocchio=FrameFunction("getFrameVelocity"),
        errors=_by_part(lambda size: size.velocity, lambda size: 0 * size.omega),
        scale=VELOCITY,
        of_frame=True,
        conventions=_BY_REFERENCE,
    ),
    Quantity(
        name="frame_acceleration",
        ours=frame_verb("frame_acceleration"),
        pinocchio=FrameFunction("getFrameClassicalAcceleration", spatial="getFrameAcceleration"),
        errors=_acceleration_errors,
        scale=_ACCELERATION,
        of_frame=True,
        conventions={**_BY_REFERENCE, "acceleration": ("classical", "spatial")},
    ),
    Quantity(
        name="frame_acceleration_spatial",
        ours=frame_verb("frame_acceleration", acceleration="spatial"),
        pinocchio=FrameFunction("getFrameAcceleration"),
        errors=_acceleration_errors,
        scale=_ACCELERATION,
        of_frame=True,
        conventions=_BY_REFERENCE,
    ),
)  # fmt: skip
