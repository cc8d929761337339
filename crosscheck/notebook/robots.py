"""A robot that was loaded: its picture, its joints and bodies."""

from __future__ import annotations

from crosscheck.report.plain_text import vector_text
from crosscheck.report.report import Column, Facts, Report, Row, Section, Table
from crosscheck.report.robot_parts import robot_picture
from graphdyn import RobotModel
from graphdyn.errors import counted


def robot_report(model: RobotModel) -> Report:
    """The picture, and a row for every joint with the body that it moves."""
    facts = [
        ("bodies", f"{counted(model.n_bodies, 'moving body', 'moving bodies')}, {_mass(model):.4g} kg"),
        ("gravity", f"{vector_text(model.gravity)} m/s²"),
    ]
    if model.couplings:
        facts.append(("coupled joints", ", ".join(coupling.joint for coupling in model.couplings)))
    if model.chords:
        facts.append(("loops", f"closed by {', '.join(chord.name for chord in model.chords)}"))
    blocks = (robot_picture(model, model.name), Facts(tuple(facts)), _joints(model))
    return Report(model.name, None, (Section("robot", "", blocks),))


def _mass(model: RobotModel) -> float:
    return sum(body.mass for body in model.bodies)


def _joints(model: RobotModel) -> Table:
    rows = tuple(
        Row((number, joint.name, joint.kind, body.name, body.mass, joint.limits.lower, joint.limits.upper))
        for number, (joint, body) in enumerate(zip(model.joints, model.bodies, strict=True), start=1)
    )
    return Table(
        (
            Column("no.", "number"),
            Column("joint", "name"),
            Column("kind"),
            Column("moves body"),
            Column("mass", "number", "kg", ".4g"),
            Column("from", "number", form=".4g", meaning="lower limit [rad or m]"),
            Column("to", "number", form=".4g", meaning="upper limit [rad or m]"),
        ),
        rows,
        failures_first=False,
    )
