"""What had to be done to lay robot B over robot A, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from crosscheck.commands.diff.robots import ComparedRobots
from graphdyn import Placement
from graphdyn.aligning import Alignment, Cause, JointMap, same_names
from graphdyn.layout import Array
from graphdyn.model import rotation_vector

AXIS_WORD_TOLERANCE = 1e-6
"""Entry of a unit vector below which it counts as zero: the axis is then called x, y or z."""


def changes_in_words(compared: ComparedRobots) -> list[str]:
    """What was done to lay B over A, as sentences; none where B is written like A but for names and link frames."""
    found, alignment = compared.found, compared.found.alignment
    joints = alignment.second.joint_names
    words = []
    for robot, who, other in zip(compared.robots, "AB", "BA", strict=True):
        if robot.held:
            words.append(f"{who}'s joints {_quoted(robot.held)} are held at 0: {other} has none of these names")
    if moved := misplaced_names(alignment):
        places = ", ".join(f"'{name}' at {here} in A and at {there} in B" for name, here, there in moved)
        words.append(f"names contradict the order from the base, which is followed: {places}")
    words += [f"B's joint '{name}' turns or slides the other way" for name in _reversed(alignment.map, joints)]
    for joint, zero in zip(alignment.second.joints, alignment.map.zeros, strict=True):
        if abs(zero) > found.tolerance:
            size = f"{zero:.6g} m" if joint.is_prismatic else f"{degrees(zero)}°"
            words.append(f"B's zero of joint '{joint.name}' is at {size}")
    words += [f"B's base is {moved}" for moved in _moved(alignment.map.base, found.tolerance)]
    words += [f"B's last link frame is {moved}, in A's" for moved in _moved(alignment.map.tool, found.tolerance)]
    renamed = [
        f"'{one}' = '{other}'" for one, other in zip(alignment.first.joint_names, joints, strict=True) if one != other
    ]
    if renamed:
        words.append(f"joints of A and B: {', '.join(renamed)}")
    gravity = alignment.map.base.rotation @ alignment.second.gravity
    strength = float(np.linalg.norm(alignment.first.gravity))
    if np.linalg.norm(gravity - alignment.first.gravity) > found.tolerance * (strength or 1.0):
        words.append(f"B's gravity is {_vector(gravity)} m/s² in A's world; torques of both are under A's")
    return words


def misplaced_names(alignment: Alignment) -> list[tuple[str, int, int]]:
    """Names that both robots have, at other places: A's, and the numbers of the two joints from the base, from 1."""
    names = [robot.joint_names for robot in (alignment.first, alignment.second)]
    same = same_names(*names)
    places = [(one, names[0].index(one) + 1, names[1].index(other) + 1) for one, other in same.items()]
    return [each for each in places if each[1] != each[2]]


def map_in_words(alignment: Alignment, other: JointMap) -> str:
    """Another map of the class, in a line."""
    names = alignment.second.joint_names
    parts = []
    if reversed_ones := list(_reversed(other, names)):
        parts.append(f"other way: {', '.join(reversed_ones)}")
    zeros = [
        f"{joint.name} at {f'{zero:.6g} m' if joint.is_prismatic else f'{degrees(zero)}°'}"
        for joint, zero in zip(alignment.second.joints, other.zeros, strict=True)
        if degrees(zero) != "0"
    ]
    if zeros:
        parts.append(f"zeros: {', '.join(zeros)}")
    return "; ".join(parts) or "no change of joints"


def causes_in_words(causes: Sequence[Cause]) -> str:
    """Other causes of a difference: \"the axis of 'joint_1', or the length of 'joint_3'\"."""
    return ", or ".join(f"the {each.kind} of '{each.element}'" for each in causes)


def degrees(angle: float) -> str:
    """An angle [rad] in degrees, without a digit that rounding made."""
    return f"{round(float(np.degrees(angle)), 4) + 0.0:g}"


def _quoted(names: Sequence[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)


def _reversed(joint_map: JointMap, names: tuple[str, ...]) -> Iterator[str]:
    return (name for name, sign in zip(names, joint_map.signs, strict=True) if sign < 0)


def _moved(frame: Placement, tolerance: float) -> Iterator[str]:
    """How a frame is turned and moved."""
    vector = rotation_vector(frame.rotation)
    angle = float(np.linalg.norm(vector))
    if angle > tolerance:
        forward = 1.0 if vector[int(np.abs(vector).argmax())] > 0 else -1.0
        yield f"turned by {degrees(forward * angle)}° about {_direction(forward * vector / angle)}"
    if np.linalg.norm(frame.translation) > tolerance:
        yield f"moved by {_vector(frame.translation)} m"


def _vector(vector: Array) -> str:
    return f"({', '.join(f'{x + 0.0:.6g}' for x in np.round(vector, 9))})"


def _direction(axis: Array) -> str:
    for k, letter in enumerate("xyz"):
        if abs(abs(axis[k]) - 1) < AXIS_WORD_TOLERANCE:
            return letter
    return f"({', '.join(f'{x + 0.0:.4g}' for x in np.round(axis, 6))})"
