"""Two robots in the same link frames, field by field: joints, links, named frames, drives and limits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from graphdyn.aligning.axes import JointAxes, angle_between, rotation_angle
from graphdyn.aligning.causes import Cause
from graphdyn.display import short_repr
from graphdyn.model.robot_model import RobotModel

TORQUE_SETTINGS = ("armature", "damping", "friction")
LIMIT_NAMES = ("lower", "upper", "velocity", "effort")


@dataclass(frozen=True)
@short_repr
class JointDifference:
    """One thing that is different at a joint of A.

    joint: its name in A
    kind: "length" (where its axis lies in the link before it), "angle" (how that link turns it), or "axis" (its
        direction alone: the links outside of it are turned as before)
    link: the link before it, in which the difference is; where a length lies along the axis before it, link and
        inertia are what said so
    value: size                                             [m or rad]
    or_else: other changes, each of which would explain the differences of this joint as well
    """

    joint: str
    kind: Literal["length", "angle", "axis"]
    link: str
    value: float
    or_else: tuple[Cause, ...] = ()

    @property
    def unit(self) -> str:
        """The unit of the value."""
        return "m" if self.kind == "length" else "rad"


@dataclass(frozen=True)
@short_repr
class LinkDifference:
    """One thing that is different in the inertia of a link.

    link: its name in A
    kind: "mass", "center" or "tensor" (about the center of mass)
    value: B's mass minus A's [kg]; distance of the centers [m]; largest difference of an entry [kg m²]
    relative: value as a part of A's mass, the reach, A's largest entry; infinite where that is zero
    or_else: other changes, each of which would explain the differences of this link as well
    """

    link: str
    kind: Literal["mass", "center", "tensor"]
    value: float
    relative: float
    or_else: tuple[Cause, ...] = ()

    @property
    def unit(self) -> str:
        """The unit of the value."""
        return {"mass": "kg", "center": "m", "tensor": "kg m²"}[self.kind]


@dataclass(frozen=True)
@short_repr
class FrameDifference:
    """A named frame of both robots, such as a flange, that is elsewhere in its link.

    name: in A and B; link: of A, which carries it
    distance: of the origins [m]; angle: by which one is turned against the other [rad]
    """

    name: str
    link: str
    distance: float
    angle: float


@dataclass(frozen=True)
@short_repr
class SettingDifference:
    """Another armature, damping, friction or limit of a joint; None where a robot states no limit.

    A limit of velocity or effort that one robot does not state is told, and does not count: MJCF has none of velocity.

    joint: its name in A
    name: "armature", "damping", "friction", or that of a limit: "lower", "upper", "velocity", "effort"
    first, second: of A, and of B for A's joint positions
    """

    joint: str
    name: str
    first: float | None
    second: float | None

    @property
    def shows_in_torque(self) -> bool:
        """Whether it changes what an actuator must give."""
        return self.name in TORQUE_SETTINGS

    @property
    def counts(self) -> bool:
        """Whether the robots disagree in it; False where one of them does not say."""
        return self.name not in ("velocity", "effort") or None not in (self.first, self.second)


def joint_differences(first: RobotModel, model: RobotModel, tolerance: float) -> tuple[JointDifference, ...]:
    """Joints of which axis or placement differ, from the base outward."""
    reach = JointAxes.of(first).reach
    found = []
    for one, other in zip(first.joints, model.joints, strict=True):
        link = (first.base_name, *first.body_names)[one.inside]
        apart = other.placement.translation - one.placement.translation
        length = float(np.linalg.norm(apart))
        turned = rotation_angle(one.placement.rotation.T @ other.placement.rotation)
        tilted = angle_between(one.axis, other.axis)
        if length > tolerance * reach:
            found.append(JointDifference(one.name, "length", link, length))
        if turned > tolerance:
            found.append(JointDifference(one.name, "angle", link, turned))
        if tilted > tolerance:
            found.append(JointDifference(one.name, "axis", link, tilted))
    return tuple(found)


def link_differences(first: RobotModel, model: RobotModel, tolerance: float) -> tuple[LinkDifference, ...]:
    """Links of which mass, center of mass or tensor differ. A link without mass has no center of mass."""
    reach = JointAxes.of(first).reach
    found: list[LinkDifference] = []
    for one, other in zip(first.bodies, model.bodies, strict=True):
        apart = float(np.linalg.norm(other.center_of_mass - one.center_of_mass)) if one.mass and other.mass else 0.0
        tensor, largest = float(np.abs(other.inertia - one.inertia).max()), float(np.abs(one.inertia).max())
        mass = other.mass - one.mass
        if abs(mass) > tolerance * max(one.mass, other.mass):
            found.append(LinkDifference(one.name, "mass", mass, _part(abs(mass), one.mass)))
        if apart > tolerance * reach:
            found.append(LinkDifference(one.name, "center", apart, apart / reach))
        if tensor > tolerance * max(largest, float(np.abs(other.inertia).max())):
            found.append(LinkDifference(one.name, "tensor", tensor, _part(tensor, largest)))
    return tuple(found)


def frame_differences(first: RobotModel, model: RobotModel, tolerance: float) -> tuple[FrameDifference, ...]:
    """Named frames that both robots have on a link, where they differ."""
    reach, here, found = JointAxes.of(first).reach, {frame.name: frame for frame in first.frames}, []
    for frame in model.frames:
        one, other = here[frame.name].placement, frame.placement
        distance = float(np.linalg.norm(other.translation - one.translation))
        angle = rotation_angle(one.rotation.T @ other.rotation)
        if distance > tolerance * reach or angle > tolerance:
            found.append(FrameDifference(frame.name, first.body_names[frame.body - 1], distance, angle))
    return tuple(found)


def setting_differences(first: RobotModel, model: RobotModel, tolerance: float) -> tuple[SettingDifference, ...]:
    """Armature, damping, friction and limits that differ."""
    return tuple(_settings(first, model, tolerance))


def _settings(first: RobotModel, model: RobotModel, tolerance: float) -> Iterator[SettingDifference]:
    for one, other in zip(first.joints, model.joints, strict=True):
        pairs: list[tuple[str, float | None, float | None]] = [
            *((name, getattr(one, name), getattr(other, name)) for name in TORQUE_SETTINGS),
            *((name, getattr(one.limits, name), getattr(other.limits, name)) for name in LIMIT_NAMES),
        ]
        for name, a, b in pairs:
            if a is None or b is None:
                if a is not b:
                    yield SettingDifference(one.name, name, a, b)
            elif abs(a - b) > tolerance * max(abs(a), abs(b), 1.0 if name in LIMIT_NAMES else 0.0):
                yield SettingDifference(one.name, name, a, b)


def _part(value: float, whole: float) -> float:
    return value / whole if whole else float("inf")
