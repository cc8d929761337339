"""What several reports tell of a robot: its picture, its joints, what is locked."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from crosscheck.report.pictures.stick_figure import pose_text, stick_figure
from crosscheck.report.report import Column, RobotPicture, Row, Table
from graphdyn import RobotModel
from graphdyn.layout import Array
from graphdyn.model import unit_of
from urdf.reading import Chain


def reading_text(locked: Mapping[str, float], chain: Chain = None) -> str:
    """ " from base to hand, locked: finger = 0.02", or nothing."""
    cut = f" from {chain[0]} to {chain[1]}" if chain else ""
    held = ", ".join(f"{joint} = {value:g}" for joint, value in locked.items())
    return f"{cut}, locked: {held}" if held else cut


def joint_units(model: RobotModel) -> str:
    """Units of positions, velocities and torques or forces, in a line."""
    pairs = (("rad", "m"), ("rad/s", "m/s"), ("N m", "N"))
    return ", ".join(unit_of(model.joints, *pair) for pair in pairs)


def robot_picture(model: RobotModel, name: str, q: Array | None = None) -> RobotPicture:
    """The robot as a stick figure. name: for readers who do not see it; q: of a given state (n,)"""
    pose = pose_text(model) if q is None else "At the given state"
    chords = ", ◇ and c: chords, which close loops" if model.chords else ""
    caption = (
        f"{pose}. ○ revolute joint and its axis, □ prismatic joint and its direction{chords}, discs: centers of "
        "mass, area as the mass, ×: fixed frames, gray band: the links seen from above."
    )
    return RobotPicture(partial(stick_figure, model=model, name=name, q=q), caption, wide=False, on=("page",))


def joints_table(model: RobotModel) -> Table:
    """Joints by number, each with the body that it moves; for the page, folded."""
    return Table(
        (
            Column("no.", "number"),
            Column("joint", "name"),
            Column("kind"),
            Column("body"),
            Column("mass", "number", "kg", ".4g"),
        ),
        tuple(
            Row((number, joint.name, joint.kind, body.name, body.mass))
            for number, (joint, body) in enumerate(zip(model.joints, model.bodies, strict=True), start=1)
        ),
        title="Joints and bodies",
        on=("page",),
        folded=True,
    )
