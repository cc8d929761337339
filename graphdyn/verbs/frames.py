"""The public verbs that answer how a named frame moves.

A frame is named as in RobotModel.frame: a body, the ground, a link fused into its parent, or the fixed joint that
carried it. Reference says where and in which axes, with the words of Pinocchio:

- "local": at the origin of the frame, in its own axes
- "local_world_aligned": at the origin of the frame, in world axes
- "world": in world axes at the world's origin, as if it were a point of the body (the spatial velocity of textbooks)

Linear first. Leading dimensions of the arguments broadcast.
"""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from graphdyn.arguments.choices import Reference, VerbKeywords, frame_choice
from graphdyn.equations import complex_steps, frame_motion
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.verb import computed, verb

__all__ = [
    "frame_acceleration",
    "frame_jacobian",
    "frame_jacobian_derivative",
    "frame_velocity",
]


@verb(frame_motion.frame_jacobian)
def frame_jacobian(
    model: RobotModel, q: ArrayLike, frame: str, *, reference: Reference, **keywords: Unpack[VerbKeywords[Array]]
) -> Array:
    """J (…, 6, n): frame_velocity = J v, on a base at rest [m, 1 of revolute joints, 1, 0 of prismatic ones].

    The same matrix serves classical and spatial accelerations, which differ in what is added to J a
    (frame_jacobian_derivative). Jᵀ turns a wrench on the frame, at the point and in the axes of the reference, into
    joint torques.
    q: joint positions (…, n) [rad or m]. Of the motion of a base only the placement counts.
    frame, reference: whose Jacobian, and "local", "local_world_aligned" or "world" (see frame_velocity)

    Raises UnknownFrame, InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> jacobian = graphdyn.frame_jacobian(model, q, "B6", reference="local")
    >>> bool(np.allclose(jacobian @ v, graphdyn.frame_velocity(model, q, v, "B6", reference="local")))
    True
    """
    choice = frame_choice(model, frame, reference)
    return computed(frame_jacobian, model, (q,), keywords, frame=choice)


@verb(frame_motion.frame_velocity)
def frame_velocity(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    frame: str,
    *,
    reference: Reference,
    **keywords: Unpack[VerbKeywords[Array]],
) -> Array:
    """Linear velocity and ω of a frame (…, 6) [m/s, rad/s]; of velocities, classical and spatial are the same.

    q, v: joint state (…, n) [rad or m, …/s]
    frame: a body, the ground, a fused link or its fixed joint (RobotModel.frame)
    reference: "local": of the frame's origin, in its own axes; "local_world_aligned": of the frame's origin, in world
        axes; "world": of the point of the body, or of the space it carries with it, that passes the world's origin, in
        world axes. These are Pinocchio's LOCAL, LOCAL_WORLD_ALIGNED and WORLD

    Raises UnknownFrame, InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> velocity = graphdyn.frame_velocity(model, q, v, "B1", reference="world")
    >>> round(float(velocity[5]), 6)  # B1 turns about the vertical
    0.1
    """
    choice = frame_choice(model, frame, reference)
    return computed(frame_velocity, model, (q, v), keywords, frame=choice)


@verb(frame_motion.frame_acceleration)
def frame_acceleration(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    frame: str,
    *,
    reference: Reference,
    classical: bool = True,
    **keywords: Unpack[VerbKeywords[Array]],
) -> Array:
    """Linear acceleration, classical or spatial, and ω̇ of a frame (…, 6) [m/s², rad/s²], without gravity.

    q, v, a: joint state and accelerations (…, n) [rad or m, …/s, …/s²]
    frame, reference: as in frame_velocity
    classical: the acceleration of the point that the reference speaks of, what an accelerometer at rest in gravity-free
        space would read; with False the spatial one, which is less by ω × ẋ, and the derivative of the spatial
        velocity (Featherstone, 2008, section 2.11). Pinocchio's getFrameClassicalAcceleration and getFrameAcceleration

    Raises UnknownFrame, InvalidInput.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> graphdyn.frame_acceleration(model, q, v, np.zeros(6), "B6", reference="local").shape
    (6,)
    """
    choice = frame_choice(model, frame, reference, classical)
    return computed(frame_acceleration, model, (q, v, a), keywords, frame=choice)


@verb(complex_steps.frame_jacobian_derivative)
def frame_jacobian_derivative(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    frame: str,
    *,
    reference: Reference,
    **keywords: Unpack[VerbKeywords[Array]],
) -> Array:
    """J̇ (…, 6, n): the derivative in time of each entry of frame_jacobian, on a base at rest.

    J a + J̇ v is the derivative in time of frame_velocity: with "local" and "world" the spatial acceleration, with
    "local_world_aligned" the classical one.
    q, v: joint state (…, n) [rad or m, …/s]
    frame, reference: as in frame_velocity

    Raises UnknownFrame; InvalidInput, also for a base that moves.

    >>> import graphdyn, numpy as np
    >>> model, q, v = graphdyn.kr500(), np.full(6, 0.3), np.full(6, 0.1)
    >>> rate = graphdyn.frame_jacobian_derivative(model, q, v, "B6", reference="world")
    >>> spatial = graphdyn.frame_acceleration(model, q, v, np.zeros(6), "B6", reference="world", classical=False)
    >>> bool(np.allclose(rate @ v, spatial))
    True
    """
    choice = frame_choice(model, frame, reference)
    if (base := keywords.get("base")) and base.moves:
        raise InvalidInput("frame_jacobian_derivative takes a base at rest: the axes of a moving one turn, too")
    return computed(frame_jacobian_derivative, model, (q, v), keywords, frame=choice)
