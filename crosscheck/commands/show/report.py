"""`graphdyn show`: a robot, its graph and its equations, as a report."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crosscheck.commands.show.character_pattern import Pattern
from crosscheck.commands.show.character_pattern import picture as character_pattern
from crosscheck.commands.show.description import RobotDescription
from crosscheck.commands.show.loops_report import loops_section
from crosscheck.commands.show.record import record
from crosscheck.commands.show.state_report import state_section
from crosscheck.report.plain_text import matrix_lines, vector_text
from crosscheck.report.report import (
    Block,
    CharacterPicture,
    Column,
    Facts,
    Group,
    Lines,
    Note,
    Notes,
    Picture,
    Prose,
    Report,
    Row,
    Section,
    Table,
)
from crosscheck.report.robot_parts import reading_text, robot_picture
from graphdyn import RobotModel
from graphdyn.errors import counted

if TYPE_CHECKING:
    from markupsafe import Markup

VECTOR_FORMAT: dict[str, Any] = {"kind": "vector", "form": vector_text}
NUMBER_FORMAT: dict[str, Any] = {"kind": "number", "form": ".4g"}


def show_report(robot: RobotDescription, model: RobotModel) -> Report:
    return Report(
        Path(robot.robot).name,
        None,
        (
            Section("robot", "", (*_overview(robot, model), _bodies(robot))),
            *([] if robot.state is None else [state_section(robot.state, model)]),
            Section("joints", "Joints", (_joints(robot, model), *_couplings(robot), _limits(robot), _frames(robot))),
            *([] if robot.loops is None else [loops_section(robot, robot.loops)]),
            Section("graph", "Graph", _graph(robot)),
            Section("equations", f"Eq. (111): {robot.system.size} equations", _equations(robot)),
        ),
        record=lambda _: record(robot),
    )


def _overview(robot: RobotDescription, model: RobotModel) -> tuple[Block, ...]:
    name = Path(robot.robot).name
    facts = (
        (
            "robot",
            f"{robot.robot}: {counted(len(robot.bodies), 'body', 'bodies')}, {counted(len(robot.joints), 'joint')}"
            f"{reading_text(robot.locked)}",
        ),
        ("total mass", f"{robot.total_mass:.6g} kg"),
        ("gravity", f"{vector_text(robot.gravity)} m/s², world axes"),
        (
            "ground",
            f"'{robot.base}', in the world at {vector_text(robot.base_xyz)} m, rpy {vector_text(robot.base_rpy)}°",
        ),
    )
    q = None if robot.state is None else np.array(robot.state.q)
    return robot_picture(model, name, q), Group((Facts(facts), _consistency(robot)))


def _consistency(robot: RobotDescription) -> Notes:
    """A note per body that no real body can be, or one for all."""
    impossible = [body for body in robot.bodies if not body.consistent]
    notes = [
        Note(f"not physically consistent: {'; '.join(body.problems)}", where=f"body '{body.name}'", state="disagrees")
        for body in impossible
    ]
    return Notes(tuple(notes) or (Note("every body is physically consistent", state="agrees"),))


def _bodies(robot: RobotDescription) -> Table:
    return Table(
        (
            Column("no.", "number"),
            Column("body", "name"),
            Column("mass", unit="kg", **NUMBER_FORMAT),
            Column("center of mass", unit="m", meaning="in link axes", **VECTOR_FORMAT),
            Column("principal moments", unit="kg m²", meaning="about the center of mass, ascending", **VECTOR_FORMAT),
        ),
        tuple(
            Row(
                (body.number, body.name, body.mass, body.center_of_mass, body.principal_moments),
                "plain" if body.consistent else "disagrees",
            )
            for body in robot.bodies
        ),
        title="Bodies",
        failures_first=False,
    )


def _joints(robot: RobotDescription, model: RobotModel) -> Table:
    return Table(
        (
            Column("no.", "number"),
            Column("joint", "name"),
            Column("kind"),
            Column("bodies", meaning="from body → to body, 0 is the ground"),
            Column("axis", **VECTOR_FORMAT),
            Column(
                "xyz", unit="m", meaning="the joint frame in the link frame of the body it starts from", **VECTOR_FORMAT
            ),
            Column("rpy", unit="°", **VECTOR_FORMAT),
        ),
        tuple(
            Row((j.number, j.name, j.kind, f"{edge.inside} → {j.number}", j.axis, j.xyz, j.rpy))
            for j, edge in zip(robot.joints, model.joints, strict=True)
        ),
        caption="from body → to body, 0 is the ground",
    )


def _couplings(robot: RobotDescription) -> list[Block]:
    if not robot.couplings:
        return []
    rows = [
        Row((c.joint, " + ".join(f"{ratio:.6g} {name}" for name, ratio in c.ratios.items()), c.offset))
        for c in robot.couplings
    ]
    columns = (Column("joint", "name"), Column("driven as", "name"), Column("offset", **NUMBER_FORMAT))
    return [Table(columns, tuple(rows), title="Couplings", caption="rad or m; q, v and τ have no entries for them")]


def _limits(robot: RobotDescription) -> Table:
    names = ("lower", "upper", "velocity", "effort", "damping", "friction")
    return Table(
        (Column("no.", "number"), Column("joint", "name"), *(Column(name, **NUMBER_FORMAT) for name in names)),
        tuple(Row((joint.number, joint.name, *(getattr(joint, name) for name in names))) for joint in robot.joints),
        title="Limits, damping and friction",
        caption="rad or m, …/s, N m or N",
        repeated=2,
    )


def _frames(robot: RobotDescription) -> Block:
    if not robot.frames:
        return Prose("No named frames", soft=True)
    return Table(
        (
            Column("frame", "name"),
            Column("also called"),
            Column("in body"),
            Column("xyz", unit="m", **VECTOR_FORMAT),
            Column("rpy", unit="°", **VECTOR_FORMAT),
        ),
        tuple(Row((frame.name, ", ".join(frame.aliases), frame.body, frame.xyz, frame.rpy)) for frame in robot.frames),
        title="Frames",
    )


def _graph(robot: RobotDescription) -> tuple[Block, ...]:
    graph = robot.graph
    matrices = (
        Lines(tuple(matrix_lines(graph.incidence)), title="incidence S"),
        Lines(tuple(matrix_lines(graph.path)), title="path matrix T"),
        Lines(tuple(matrix_lines(graph.force_element)), title="force elements S^e"),
    )
    rows = [
        Row((body.number, body.name, joint.number, joint.name, sign, vector))
        for body, signs, vectors in zip(robot.bodies, graph.incidence, graph.body_joint_vectors, strict=True)
        for joint, sign, vector in zip(robot.joints, signs, vectors, strict=True)
        if sign != 0
    ]
    table = Table(
        (
            Column("i", "number"),
            Column("body", "name"),
            Column("j", "number"),
            Column("joint", "name"),
            Column("S_ij", "number", form="+d"),
            Column("C_ij", unit="m", **VECTOR_FORMAT),
        ),
        tuple(rows),
        title="Body-joint vectors C",
        caption="S_ij times the vector from the center of mass of body i to joint j, in axes of i",
    )
    words = Prose("Row = body, column = joint; of T: row = joint, column = body.", soft=True)
    return words, *matrices, table


def _equations(robot: RobotDescription) -> tuple[Block, ...]:
    system = robot.system
    size, n = system.size, len(robot.bodies)
    chords = [] if robot.loops is None else [len(chord.rows) for chord in robot.loops.chords]
    pattern = np.array([[entry == "1" for entry in row] for row in system.pattern])
    entries = int(pattern.sum())
    rank = f"{system.rank} of {size}"
    if robot.loops is not None and system.rank < size:
        rank += ": rows of loops depend on each other, and accelerations are unique all the same"
    facts = (
        ("state", f"random, seed {system.seed}"),
        ("entries", f"{entries} of {size**2} are not zero ({entries / size**2:.1%})"),
        ("rank", rank),
        ("condition number", f"{system.condition_number:.4g}"),
    )
    caption = "Upper left A, upper right φ_qᵀ, lower left φ_q; b: body, j: joint"
    caption += ", c: chord." if chords else "."
    return (
        CharacterPicture(lambda width: character_pattern(pattern, n, width, chords)),
        Picture(partial(_drawn, pattern=pattern, n=n, chords=chords), caption, wide=False),
        Group((Facts(facts),)),
    )


def _drawn(key: str, pattern: Pattern, n: int, chords: Sequence[int]) -> Markup:
    from crosscheck.commands.show.matrix_pattern import matrix_pattern

    return matrix_pattern(key, pattern, n, chords)
