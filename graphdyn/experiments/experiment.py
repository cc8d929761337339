"""Virtual experiments: prescribe a motion, record what instruments at every joint and body would show.

It replaces the simulation of section 3.1 of the paper. Nothing is integrated: laws give the motion exactly, the inverse
dynamics give the forces.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.equations.kinematics import maximal_state
from graphdyn.errors import InvalidInput
from graphdyn.experiments.virtual_recording import VirtualRecording
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.model.spatial import rotation_about
from graphdyn.motion_laws import Course, Locked, MotionLaw, Rail, Turntable
from graphdyn.verbs.answers import InverseDynamics
from graphdyn.verbs.dynamics import inverse_dynamics

BaseMotionLaw = Rail | Turntable


def simulate_recording(
    model: RobotModel,
    times: ArrayLike,
    joints: Mapping[str, MotionLaw] | Sequence[MotionLaw],
    *,
    base: BaseMotionLaw | Sequence[BaseMotionLaw] = (),
) -> VirtualRecording:
    """Move the robot as prescribed and record everything.

    times: increasing                                       (N,)  [s]
    joints: law per joint name, joints without one are locked at 0; or one law per joint, in the order of the model.
        Joints that others drive take none: their motion is recorded with a torque of zero
    base: motion of the moving base that carries the ground frame: rails, whose displacements add, and at most one
        turntable

    Raises InvalidInput for unknown joints, laws that answer anything but three finite arrays (N,), wrong times.

    >>> import graphdyn, numpy as np
    >>> from graphdyn.motion_laws import ConstantAcceleration
    >>> turning = {"O1": ConstantAcceleration(0.5)}  # 0.5 rad/s² from rest
    >>> recording = graphdyn.simulate_recording(graphdyn.kr500(), np.linspace(0, 2, 5), turning)
    >>> recording.v[:, 0]
    array([0.  , 0.25, 0.5 , 0.75, 1.  ])
    """
    check_model(model)
    times = np.atleast_1d(as_floats("times", times))
    if times.ndim != 1 or not np.all(np.isfinite(times)):
        raise InvalidInput(f"times must be finite numbers of shape (N,); they have shape {times.shape}")
    courses = [_course(f"joint '{name}'", law, times) for name, law in _laws(model, joints).items()]
    q, v, a = (np.stack(part, axis=-1) for part in zip(*courses, strict=True))
    motion = base_motion(base, times)
    answer = inverse_dynamics(model, q, v, a, base=motion, method="reproducible")
    return observed(model, times, (q, v, a), answer, motion, answer.tau)


def observed(
    model: RobotModel, times: Array, course: Course, answer: InverseDynamics, base: BaseMotion, tau: Array
) -> VirtualRecording:
    """What instruments show of a motion q, v, a, whose inverse dynamics are the answer, and whose actuators give tau.

    Arrays (N, n) as the verbs take them; joints that others drive are recorded with a torque of zero.
    """
    q, v, a = course
    state = maximal_state(model, q, v, a, base=base, method="reproducible")
    if model.couplings:
        given = tau
        q, v, a = model.joint_positions(q), v @ model.degrees_of_freedom.matrix.T, a @ model.degrees_of_freedom.matrix.T
        tau = np.zeros_like(q)
        tau[..., list(model.degrees_of_freedom.independent)] = given

    def in_world(vectors: Array) -> Array:
        turned: Array = np.einsum("...ab,...b->...a", state.rotation, vectors)
        return turned

    return VirtualRecording(
        robot=model.name,
        joint_names=model.joint_names,
        body_names=model.body_names,
        prismatic=tuple(joint.is_prismatic for joint in model.joints),
        time=times,
        q=q,
        v=v,
        a=a,
        tau=tau,
        cardano=state.cardano,
        position=state.position,
        acceleration=answer.body_accelerations[..., LINEAR],
        angular_velocity=in_world(state.velocity[..., ANGULAR]),
        angular_acceleration=in_world(answer.body_accelerations[..., ANGULAR]),
        joint_forces=in_world(answer.joint_wrenches[..., LINEAR]),
        joint_moments=in_world(answer.joint_wrenches[..., ANGULAR]),
    )


def _laws(model: RobotModel, joints: Mapping[str, MotionLaw] | Sequence[MotionLaw]) -> dict[str, MotionLaw]:
    """A law for every joint, in the order of the model."""
    known = f"joints of robot '{model.name}': {', '.join(model.independent_joints)}"
    if not isinstance(joints, Mapping):
        if len(joints) != model.nv:
            raise InvalidInput(
                f"{len(joints)} motion laws for {model.nv} joints; give one each, or name them ({known})"
            )
        return dict(zip(model.independent_joints, joints, strict=True))
    unknown = [name for name in joints if name not in model.independent_joints]
    if unknown:
        raise InvalidInput(f"there is no joint '{unknown[0]}'; {known}")
    return {name: joints.get(name, Locked()) for name in model.independent_joints}


def _course(who: str, law: MotionLaw, times: Array) -> Course:
    if not callable(law):
        raise InvalidInput(
            f"{who}: {law!r} is not a motion law; take one of graphdyn.motion_laws, such as Locked(position)"
        )
    course = tuple(as_floats(f"{who}: the law's answer", part) for part in law(times))
    if [part.shape for part in course] != [times.shape] * 3 or not all(np.all(np.isfinite(part)) for part in course):
        raise InvalidInput(
            f"{who}: the law must answer position, velocity and acceleration, finite and of shape {times.shape}; "
            f"it answers {', '.join(str(part.shape) for part in course)}"
        )
    position, velocity, acceleration = course
    return position, velocity, acceleration


def base_motion(base: BaseMotionLaw | Sequence[BaseMotionLaw], times: Array) -> BaseMotion:
    """Rails move the origin of the moving base, the turntable turns it about that origin: their order does not
    matter."""
    laws = (base,) if isinstance(base, BaseMotionLaw) else tuple(base)
    rotation, linear, angular = np.eye(3), np.zeros((3, *times.shape, 3)), np.zeros((3, *times.shape, 3))
    if sum(isinstance(law, Turntable) for law in laws) > 1:
        raise InvalidInput("the base has more than one turntable; turns about several axes do not add: give one")
    for law in laws:
        if isinstance(law, Rail):
            linear += np.stack(_course("rail", law.law, times))[..., None] * np.array(law.direction)
        elif isinstance(law, Turntable):
            course = _course("turntable", law.law, times)
            angular += np.stack(course)[..., None] * np.array(law.axis)
            rotation = rotation_about(law.axis, course[0])
        else:
            raise InvalidInput(f"the base cannot move by {law!r}; use Rail or Turntable of graphdyn.motion_laws")
    velocity, acceleration = (np.concatenate([linear[k], angular[k]], axis=-1) for k in (1, 2))
    return BaseMotion(rotation, linear[0], velocity, acceleration)
