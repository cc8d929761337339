"""Robots to be shown: their shapes, or cylinders in place of them, and what is missing."""

from __future__ import annotations

import urdf
from crosscheck.viewing.figures import BodyShape, ShownRobot
from crosscheck.viewing.stand_ins import stand_ins
from graphdyn import RobotModel
from urdf import Reading


def shown_robot(source: str, model: RobotModel, reading: Reading, faces: int) -> ShownRobot:
    """The robot that urdf.load made of a source, with what the file says that it looks like.

    Raises the errors of urdf.shapes.
    """
    shapes = urdf.shapes(source, faces=faces, reading=reading)
    numbers = {name: number for number, name in enumerate((model.base_name, *model.body_names))}
    placed = tuple(
        BodyShape(
            numbers[shape.body],
            shape.vertices @ shape.placement.rotation.T + shape.placement.translation,
            shape.faces,
            shape.color,
        )
        for shape in shapes.meshes
    )
    notes = [f"{shape.link}: {shape.file or 'a shape'} is not shown: {shape.reason}" for shape in shapes.missing]
    if not placed:
        notes.insert(0, "cylinders from joint to joint, in place of shapes")
    return ShownRobot(model, placed or stand_ins(model), tuple(notes))
