"""Robots to be shown: their shapes, or cylinders along the edges of the graph in place of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import urdf
from crosscheck.viewing.figures import BodyShape, ShownRobot
from graphdyn import RobotModel
from graphdyn.layout import Array
from urdf import Reading

STAND_IN_COLOR = (0.55, 0.63, 0.71, 1.0)

CYLINDER_SIDES = 24

MIN_THICKNESS, MAX_THICKNESS = 0.02, 0.05
"""Radius of a cylinder, as parts of its own length."""

COLLISION_FACES_SHARE = 0.25
"""Triangles of collision shapes, as a part of those of the shapes."""

MIN_LINK_SHARE = 1e-3
"""Joints nearer to each other than this part of that length are not linked."""


def stand_ins(model: RobotModel) -> tuple[BodyShape, ...]:
    """Per body cylinders from its inside joint to outside joints and chords; to a frame or its center where it ends.

    The radius is that of the homogeneous cylinder with the moment of the body about this line, within limits.
    """
    size = reach(model)
    return tuple(
        BodyShape(body, *_cylinder(end, _radius(model, body, end)), STAND_IN_COLOR)
        for body, end in _edges(model)
        if np.linalg.norm(end) > MIN_LINK_SHARE * size
    )


def reach(model: RobotModel) -> float:
    """Length from the ground to the farthest joint or center of mass, along the bodies [m]; 1 where there is none."""
    lengths = [0.0]
    for joint in model.joints:
        lengths.append(lengths[joint.inside] + float(np.linalg.norm(joint.placement.translation)))
    ends = [float(np.linalg.norm(body.center_of_mass)) for body in model.bodies]
    return max(length + end for length, end in zip(lengths, [0.0, *ends], strict=True)) or 1.0


def _edges(model: RobotModel) -> Iterator[tuple[int, Array]]:
    """Body, and a point in its link frame to which a cylinder leads."""
    for joint in model.joints:
        yield joint.inside, joint.placement.translation
    for chord in model.chords:
        yield chord.body_i, chord.placement_i.translation
        yield chord.body_j, chord.placement_j.translation
    inner = {joint.inside for joint in model.joints} | {body for c in model.chords for body in (c.body_i, c.body_j)}
    for number, body in enumerate(model.bodies, start=1):
        if number not in inner:
            ends = [frame.placement.translation for frame in model.frames if frame.body == number]
            farthest = max(ends, key=lambda end: float(np.linalg.norm(end)), default=np.zeros(3))
            yield number, farthest if farthest.any() else 2 * body.center_of_mass


def _radius(model: RobotModel, number: int, end: Array) -> float:
    """A homogeneous cylinder has the moment m r² / 2 about its axis."""
    length = float(np.linalg.norm(end))
    if number == 0 or model.bodies[number - 1].mass == 0:
        return MIN_THICKNESS * length
    body, axis = model.bodies[number - 1], end / length
    squared = 2 * float(axis @ body.inertia @ axis) / body.mass
    return float(np.clip(np.sqrt(max(squared, 0.0)), MIN_THICKNESS * length, MAX_THICKNESS * length))


def _cylinder(end: Array, radius: float) -> tuple[Array, NDArray[np.intp]]:
    """Vertices and faces of a closed cylinder from the origin to a point."""
    axis = end / np.linalg.norm(end)
    across = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across /= np.linalg.norm(across)
    angles = 2 * np.pi * np.arange(CYLINDER_SIDES) / CYLINDER_SIDES
    circle = radius * (np.outer(np.cos(angles), across) + np.outer(np.sin(angles), np.cross(axis, across)))
    vertices = np.vstack([circle, circle + end, np.zeros(3), end])
    here = np.arange(CYLINDER_SIDES)
    after = (here + 1) % CYLINDER_SIDES
    below, above = np.full(CYLINDER_SIDES, 2 * CYLINDER_SIDES), np.full(CYLINDER_SIDES, 2 * CYLINDER_SIDES + 1)
    faces = [(here, after, here + CYLINDER_SIDES), (after, after + CYLINDER_SIDES, here + CYLINDER_SIDES)]
    faces += [(after, here, below), (here + CYLINDER_SIDES, after + CYLINDER_SIDES, above)]
    return vertices, np.vstack([np.stack(corners, axis=-1) for corners in faces]).astype(np.intp)


def shown_robot(source: str, model: RobotModel, reading: Reading, faces: int) -> ShownRobot:
    """The robot that urdf.load made of a source, with what the file says that it looks like.

    Raises the errors of urdf.shapes.
    """
    shapes = urdf.shapes(source, faces=faces, reading=reading)
    collision = urdf.shapes(
        source, geometry="collision", faces=max(1, round(COLLISION_FACES_SHARE * faces)), reading=reading
    )
    placed = _placed(model, shapes)
    notes = [f"{shape.link}: {shape.file or 'a shape'} is not shown: {shape.reason}" for shape in shapes.missing]
    if not placed:
        notes.insert(0, "cylinders from joint to joint, in place of shapes")
    told = {(shape.link, shape.file) for shape in shapes.missing}
    notes += [
        f"{shape.link}: the collision shape {shape.file or ''} is not shown: {shape.reason}"
        for shape in collision.missing
        if (shape.link, shape.file) not in told
    ]
    return ShownRobot(model, placed or stand_ins(model), tuple(notes), _placed(model, collision))


def _placed(model: RobotModel, shapes: urdf.Shapes) -> tuple[BodyShape, ...]:
    """The shapes in the link axes of their bodies."""
    numbers = {name: number for number, name in enumerate((model.base_name, *model.body_names))}
    return tuple(
        BodyShape(
            numbers[shape.body],
            shape.vertices @ shape.placement.rotation.T + shape.placement.translation,
            shape.faces,
            shape.color,
        )
        for shape in shapes.meshes
    )
