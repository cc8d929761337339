"""What differs between two aligned robots: axes, links, drives, limits, motion of the flange, and joint torques."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from graphdyn.aligning.alignment import COUNTED_FROM, Alignment, align
from graphdyn.aligning.causes import Cause, other_causes
from graphdyn.aligning.fields import (
    FrameDifference,
    JointDifference,
    LinkDifference,
    SettingDifference,
    frame_differences,
    joint_differences,
    link_differences,
    setting_differences,
)
from graphdyn.aligning.torques import BaseParameterDifference, TorqueDifference, base_differences, torque_differences
from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.equations.kinematics import frame_placement
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel

DifferenceVerdict = Literal["same model", "equal in all joint torques", "same kinematics only", "different robots"]

VERDICTS: tuple[DifferenceVerdict, ...] = get_args(DifferenceVerdict)
"""The first agrees in everything, the last in nothing."""


@dataclass(frozen=True, eq=False)
@short_repr
class FlangeDifference:
    """How far the flanges of two aligned robots part, where they coincide in the aligned q = 0.

    largest: over all states [m]; q: where, of A           (n,)  [rad or m]
    """

    largest: float
    q: Array


@dataclass(frozen=True, eq=False)
@short_repr
class ModelDifferences:
    """What differs between robots A and B, after B is laid over A.

    verdict: "same model", "equal in all joint torques", "same kinematics only" or "different robots"
    alignment: the map from A to B; all differences are those of B in A's link frames and joint positions
    tolerance: what does not count: relative to reach, mass, tensor and torque, and in radians
    n_states: random states within A's limits, of flange and torques
    flange: largest distance of the flanges
    joints: lengths, angles and axes that differ, from the base outward
    links: masses, centers of mass and tensors that differ
    frames: named frames, such as a flange, that both robots have, but elsewhere in the same link
    torques: of every term and joint the largest difference, and its state
    base_parameters: those that differ, where the kinematics are the same
    settings: armature, damping, friction and limits that differ
    """

    verdict: DifferenceVerdict
    alignment: Alignment
    tolerance: float
    n_states: int
    flange: FlangeDifference
    joints: tuple[JointDifference, ...]
    links: tuple[LinkDifference, ...]
    frames: tuple[FrameDifference, ...]
    torques: tuple[TorqueDifference, ...]
    base_parameters: tuple[BaseParameterDifference, ...]
    settings: tuple[SettingDifference, ...]

    @property
    def first_cause(self) -> JointDifference | None:
        """The difference of the kinematics that is nearest to the base; None where there is none."""
        return self.joints[0] if self.joints else None


def differences(
    first: RobotModel, second: RobotModel, *, tolerance: float = COUNTED_FROM, samples: int = 1000, seed: int = 0
) -> ModelDifferences:
    """Lay a serial robot over another, and compare what is left.

    tolerance: what does not count as a difference: a part of reach, mass, tensor and of the moments that joints bear,
        and an angle [rad]
    samples, seed: number of random states within the limits of the first robot, and what they are drawn with

    Both robots are under the gravity of the first, which acts in its world axes. Raises InvalidInput as align does, and
    for samples that are no number of states.

    >>> import graphdyn
    >>> from graphdyn.aligning import differences
    >>> arm = graphdyn.kr500()
    >>> heavier = arm.with_inertial_parameters(1.05 * arm.inertial_parameters)
    >>> found = differences(arm, heavier, samples=20)
    >>> found.verdict, found.links[0].kind, round(found.links[0].relative, 3)
    ('same kinematics only', 'mass', 0.05)
    """
    if isinstance(samples, bool) or not isinstance(samples, int) or samples < 1:
        raise InvalidInput(f"samples is {samples!r}; give a whole number of states from 1 on")
    (tolerance,) = (float(each) for each in as_floats("tolerance", [tolerance]))
    alignment = align(first, second, tolerance=tolerance)
    model = alignment.model
    q, v = first.random_state(np.random.default_rng(seed), samples)
    joints = tuple(
        replace(each, or_else=other_causes(first, model, Cause(each.joint, each.kind), tolerance))
        for each in joint_differences(first, model, tolerance)
    )
    links = tuple(
        replace(each, or_else=other_causes(first, model, Cause(each.link, each.kind), tolerance))
        for each in link_differences(first, model, tolerance)
    )
    frames = frame_differences(first, model, tolerance)
    settings = setting_differences(first, model, tolerance)
    torques = torque_differences(first, model, q, v, tolerance)
    flange = _flange(first, model, q)
    verdict: DifferenceVerdict
    if joints:
        verdict = "different robots"
    elif any(each.counts for each in torques) or any(each.shows_in_torque for each in settings):
        verdict = "same kinematics only"
    elif links or frames or any(each.counts for each in settings):
        verdict = "equal in all joint torques"
    else:
        verdict = "same model"
    base = () if joints or not links else base_differences(first, model, q, v, tolerance)
    return ModelDifferences(
        verdict, alignment, tolerance, samples, flange, joints, links, frames, torques, base, settings
    )


def _flange(first: RobotModel, model: RobotModel, q: Array) -> FlangeDifference:
    """The point of B's last link that lies on A's last frame at q = 0, over the states."""

    def last(robot: RobotModel, positions: Array) -> tuple[Array, Array]:
        return frame_placement(robot, positions, robot.body_names[-1])

    here, there = last(first, np.zeros_like(q[:1])), last(model, np.zeros_like(q[:1]))
    point = there[0][0].T @ (here[1][0] - there[1][0])
    rotations, origins = last(model, q)
    gaps = np.linalg.norm(rotations @ point + origins - last(first, q)[1], axis=-1)
    worst = int(gaps.argmax())
    return FlangeDifference(float(gaps[worst]), q[worst])
