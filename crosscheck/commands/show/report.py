"""`graphdyn show`: a robot, its graph and its equations, as a report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.commands.show.description import RobotDescription
from crosscheck.commands.show.dh import dh_section
from crosscheck.commands.show.loops import loops_section
from crosscheck.commands.show.matrix_pattern import characters, squares
from crosscheck.commands.show.record import record
from crosscheck.commands.show.state import rpy_in_degrees, state_section
from crosscheck.exact import Proof, Result
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
    State,
    Table,
    Verdict,
)
from crosscheck.report.robot_parts import joint_units, reading_text, robot_picture
from graphdyn import RobotModel
from graphdyn.errors import counted
from graphdyn.model import unit_of

VECTOR_FORMAT: dict[str, Any] = {"kind": "vector", "form": vector_text}
RESULTS: dict[Result, State] = {"proven": "agrees", "disproven": "disagrees", "not proven": "undecided"}
"""How the result of a proof looks."""

NUMBER_FORMAT: dict[str, Any] = {"kind": "number", "form": ".4g"}


def show_report(robot: RobotDescription) -> Report:
    model = robot.model
    return Report(
        Path(robot.robot).name,
        None,
        (
            Section("robot", "", (*_overview(robot), _bodies(model))),
            *([] if robot.state is None else [state_section(robot.state, model)]),
            *([] if robot.dh is None else [dh_section(robot.dh)]),
            *([] if robot.proofs is None else [_proofs(robot.proofs)]),
            Section("joints", "Joints", (_joints(model), *_couplings(model), _limits(model), _frames(model))),
            *([] if robot.loops is None else [loops_section(robot.loops, given=robot.state is not None)]),
            Section("graph", "Graph", _graph(model)),
            Section("equations", f"Eq. (111): {robot.system.size} equations", _equations(robot)),
        ),
        record=lambda _: record(robot),
    )


def _overview(robot: RobotDescription) -> tuple[Block, ...]:
    name, model = Path(robot.robot).name, robot.model
    facts = (
        (
            "robot",
            f"{robot.robot}: {counted(model.n_bodies, 'body', 'bodies')}, {counted(model.n_bodies, 'joint')}"
            f"{reading_text(robot.locked, robot.chain)}",
        ),
        ("total mass", f"{robot.total_mass:.6g} kg"),
        ("gravity", f"{vector_text(model.gravity)} m/s², world axes"),
        (
            "ground",
            f"'{model.base_name}', in the world at {vector_text(model.base.translation)} m, "
            f"rpy {vector_text(rpy_in_degrees(model.base))}°",
        ),
    )
    q = None if robot.state is None else robot.state.q
    return robot_picture(model, name, q), Group((Facts(facts), _consistency(model)))


def _consistency(model: RobotModel) -> Notes:
    """A note per body that no real body can be, or one for all."""
    notes = [
        Note(f"not physically consistent: {'; '.join(one.problems)}", where=f"body '{one.body}'", state="disagrees")
        for one in model.physical_consistency()
        if not one.consistent
    ]
    return Notes(tuple(notes) or (Note("every body is physically consistent", state="agrees"),))


def _bodies(model: RobotModel) -> Table:
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
                (number, body.name, body.mass, body.center_of_mass, np.linalg.eigvalsh(body.inertia)),
                "plain" if verdict.consistent else "disagrees",
            )
            for number, (body, verdict) in enumerate(
                zip(model.bodies, model.physical_consistency(), strict=True), start=1
            )
        ),
        title="Bodies",
        failures_first=False,
    )


def _proofs(proofs: Sequence[Proof]) -> Section:
    rows = tuple(
        Row((proof.statement, proof.of, Verdict(RESULTS[proof.result], proof.result), proof.reason)) for proof in proofs
    )
    columns = (Column("statement"), Column("of", "name"), Column("result", "verdict"), Column("because"))
    truth = {"file": "Of the decimals of the file", "model": "Of the doubles of the model"}[proofs[0].truth]
    caption = f"{truth}, without tolerances; the state is that of the equations, or what --state says"
    return Section("proofs", "Proofs", (Table(columns, rows, caption=caption, failures_first=False),))


def _joints(model: RobotModel) -> Table:
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
            Row((k, j.name, j.kind, f"{j.inside} → {k}", j.axis, j.placement.translation, rpy_in_degrees(j.placement)))
            for k, j in enumerate(model.joints, start=1)
        ),
        caption="from body → to body, 0 is the ground",
    )


def _couplings(model: RobotModel) -> list[Block]:
    if not model.couplings:
        return []
    rows = [
        Row((c.joint, " + ".join(f"{ratio:.6g} {name}" for name, ratio in c.ratios.items()), c.offset))
        for c in model.couplings
    ]
    columns = (Column("joint", "name"), Column("driven as", "name"), Column("offset", **NUMBER_FORMAT))
    return [
        Table(
            columns,
            tuple(rows),
            title="Couplings",
            caption=f"{unit_of(model.joints, 'rad', 'm')}; q, v and τ have no entries for them",
        )
    ]


def _limits(model: RobotModel) -> Table:
    names = ("lower", "upper", "velocity", "effort", "damping", "friction")
    return Table(
        (Column("no.", "number"), Column("joint", "name"), *(Column(name, **NUMBER_FORMAT) for name in names)),
        tuple(
            Row((number, joint.name, *astuple(joint.limits), joint.damping, joint.friction))
            for number, joint in enumerate(model.joints, start=1)
        ),
        title="Limits, damping and friction",
        caption=joint_units(model),
        repeated=2,
    )


def _frames(model: RobotModel) -> Block:
    names = (model.base_name, *model.body_names)
    if not model.frames:
        return Prose("No named frames", soft=True)
    return Table(
        (
            Column("frame", "name"),
            Column("also called"),
            Column("in body"),
            Column("xyz", unit="m", **VECTOR_FORMAT),
            Column("rpy", unit="°", **VECTOR_FORMAT),
        ),
        tuple(
            Row((f.name, ", ".join(f.aliases), names[f.body], f.placement.translation, rpy_in_degrees(f.placement)))
            for f in model.frames
        ),
        title="Frames",
    )


def _graph(model: RobotModel) -> tuple[Block, ...]:
    incidence, names = model.graph.incidence(), (model.body_names, model.joint_names)
    matrices = {"incidence S": incidence, "path matrix T": model.graph.path_matrix(), "force elements S^e": incidence}
    vectors = model.body_joint_vectors()
    rows = [
        Row((i + 1, names[0][i], j + 1, names[1][j], int(incidence[i, j]), vectors[i, j]))
        for i, j in np.argwhere(incidence).tolist()
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
    lines = (Lines(tuple(matrix_lines(matrix.tolist())), title=title) for title, matrix in matrices.items())
    return words, *lines, table


def _equations(robot: RobotDescription) -> tuple[Block, ...]:
    system = robot.system
    size, n, pattern = system.size, robot.model.n_bodies, system.pattern
    chords = [len(chord.rows) for chord in robot.model.chords]
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
        CharacterPicture(lambda width: characters(pattern, n, width, chords)),
        Picture(partial(squares, pattern=pattern, n=n, chords=chords), caption, wide=False),
        Group((Facts(facts),)),
    )
