"""The data of the player, made from figures: JSON, and arrays in one compressed buffer.

Lengths in m, angles in rad, forces in N, moments in N m; matrices row by row; positions and rotations as 64-bit
numbers, loads as 32-bit numbers (6e-8 of each), vertices of shapes as 16-bit steps of their box (8e-6 of its size).
"""

from __future__ import annotations

import gzip
from base64 import b64encode
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np

from crosscheck.viewing.figures import BodyShape, Figure, LoadedMotion, ShownRobot, inertia_ellipsoid
from crosscheck.viewing.robots import reach
from graphdyn import Body, Chord, Joint, Placement, RobotModel

Kind = Literal["f4", "f8", "u2", "u4"]

ALIGNMENT = 8
"""Bytes: typed arrays of JavaScript begin at multiples of the size of their numbers."""


class NumberStore:
    """Collects arrays, little-endian. The same arrays in the same order give the same text."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._length = 0

    def add(self, array: Any, kind: Kind) -> list[Any]:
        """Kind, first byte and number of entries, from which player/numbers.js makes a typed array."""
        data = np.ascontiguousarray(array, dtype=f"<{kind}").tobytes()
        place = [kind, self._length, np.size(array)]
        padded = data + bytes(-len(data) % ALIGNMENT)
        self._parts.append(padded)
        self._length += len(padded)
        return place

    def text(self) -> str:
        """All arrays, compressed."""
        return compressed(b"".join(self._parts))


def compressed(content: bytes) -> str:
    """gzip in base64. The same content gives the same text."""
    return b64encode(gzip.compress(content, 9, mtime=0)).decode()


EARTH_GRAVITY = 9.80665
"""[m/s²]"""

VERTEX_STEPS = 65535
"""Number of steps of the position of a vertex along each edge of the box of its shape."""


def scene(title: str, figures: Sequence[Figure], store: NumberStore) -> dict[str, Any]:
    """What player/player.js reads. A robot that several figures show is written once."""
    robots = {id(figure.robot): figure.robot for figure in figures}
    numbers = {key: number for number, key in enumerate(robots)}
    return {
        "title": title,
        "robots": [_robot(robot, store) for robot in robots.values()],
        "figures": [_figure(figure, numbers[id(figure.robot)], store) for figure in figures],
    }


def _figure(figure: Figure, robot: int, store: NumberStore) -> dict[str, Any]:
    return {
        "name": figure.name,
        "robot": robot,
        "notes": [*figure.notes, *figure.robot.notes, *_ellipsoid_notes(figure.robot.model)],
        "start": figure.first.tolist(),
        "motion": None if figure.motion is None else motion_record(figure.motion, store),
    }


def _robot(robot: ShownRobot, store: NumberStore) -> dict[str, Any]:
    model, degrees_of_freedom = robot.model, robot.model.degrees_of_freedom
    return {
        "base": {"name": model.base_name, **_placement(model.base)},
        "gravity": model.gravity.tolist(),
        "usual": usual_loads(model),
        "joints": [_joint(joint) for joint in model.joints],
        "bodies": [_body(body) for body in model.bodies],
        "chords": [_chord(chord) for chord in model.chords],
        "independent": list(degrees_of_freedom.independent),
        "matrix": degrees_of_freedom.matrix.tolist(),
        "lacking": lacking_mass(model),
        "offset": degrees_of_freedom.offset.tolist(),
        "shapes": [_shape(shape, store) for shape in robot.shapes],
        "collision": [_shape(shape, store) for shape in robot.collision],
    }


def usual_loads(model: RobotModel) -> dict[str, float]:
    """What the robot lets one expect: its weight [N], and that times its reach [N m]; the largest efforts without mass.

    Weight is that on Earth where there is no gravity. Zero where nothing is known.
    """
    gravity = float(np.linalg.norm(model.gravity)) or EARTH_GRAVITY
    weight = gravity * sum(body.mass for body in model.bodies)
    if weight > 0:
        return {"force": weight, "torque": weight * reach(model)}
    efforts = {
        slides: [joint.limits.effort or 0.0 for joint in model.joints if joint.is_prismatic == slides]
        for slides in (True, False)
    }
    return {"force": max(efforts[True], default=0.0), "torque": max(efforts[False], default=0.0)}


def lacking_mass(model: RobotModel) -> list[bool]:
    """Per independent joint whether it moves a body without mass, which its torque misses."""
    carries = np.zeros((len(model.joints), model.n_bodies + 1), dtype=bool)
    for k, joint in reversed(list(enumerate(model.joints))):
        carries[k, k + 1] = True
        if joint.inside:
            carries[joint.inside - 1] |= carries[k]
    massless = np.array([False, *(body.mass == 0 for body in model.bodies)])
    lacking: list[bool] = ((model.degrees_of_freedom.matrix != 0).T @ (carries @ massless)).astype(bool).tolist()
    return lacking


def _placement(placement: Placement) -> dict[str, Any]:
    return {"rotation": placement.rotation.ravel().tolist(), "translation": placement.translation.tolist()}


def _joint(joint: Joint) -> dict[str, Any]:
    return {
        "name": joint.name,
        "kind": joint.kind,
        "inside": joint.inside,
        **_placement(joint.placement),
        "axis": joint.axis.tolist(),
        "normals": joint.axis_normals.tolist(),
        "lower": joint.limits.lower,
        "upper": joint.limits.upper,
    }


def _chord(chord: Chord) -> dict[str, Any]:
    ends = ((chord.body_i, chord.placement_i), (chord.body_j, chord.placement_j))
    return {
        "name": chord.name,
        "axis": chord.axis.tolist() if chord.kind in ("hinge", "slide") else None,
        "ends": [{"body": body, **_placement(placement)} for body, placement in ends],
    }


def _body(body: Body) -> dict[str, Any]:
    ellipsoid = inertia_ellipsoid(body)
    return {
        "name": body.name,
        "mass": body.mass,
        "center": body.center_of_mass.tolist(),
        "inertia": body.inertia.ravel().tolist(),
        "ellipsoid": ellipsoid and {"axes": ellipsoid[0].tolist(), "rotation": ellipsoid[1].ravel().tolist()},
    }


def _ellipsoid_notes(model: RobotModel) -> list[str]:
    names = [body.name for body in model.bodies if body.mass > 0 and inertia_ellipsoid(body) is None]
    return [f"no inertia ellipsoid of {', '.join(names)}: no real body has such an inertia"] if names else []


def _shape(shape: BodyShape, store: NumberStore) -> dict[str, Any]:
    low, high = shape.vertices.min(axis=0), shape.vertices.max(axis=0)
    step = np.where(high > low, (high - low) / VERTEX_STEPS, 1.0)
    return {
        "body": shape.body,
        "color": [round(float(part), 3) for part in shape.color],
        "low": low.tolist(),
        "step": step.tolist(),
        "vertices": store.add(np.rint((shape.vertices - low) / step), "u2"),
        "faces": store.add(shape.faces, "u2" if len(shape.vertices) <= VERTEX_STEPS else "u4"),
    }


def motion_record(motion: LoadedMotion, store: NumberStore) -> dict[str, Any]:
    """Time from the start of the motion, and what is known over it."""
    recorded = motion.recorded_tau
    return {
        "time": store.add(motion.time - motion.time[0], "f8"),
        "q": store.add(motion.q, "f8"),
        "wrenches": store.add(motion.joint_wrenches, "f4"),
        "tau": store.add(motion.tau, "f4"),
        "recorded": None if recorded is None else store.add(recorded, "f4"),
    }
