"""A described robot as tables for the terminal."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from rich.columns import Columns
from rich.console import Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from crosscheck.cli.pattern import picture
from crosscheck.report.plain_text import matrix_lines, vector_text
from crosscheck.studies.description import GraphRecord, RobotDescription


def text(robot: RobotDescription, width: int) -> Iterator[RenderableType]:
    """The tables in order, for a terminal this wide [characters]."""
    yield Text(_heading(robot))
    yield from _bodies(robot)
    for sentence in _consistency(robot):
        yield Text(sentence)
    yield from _joints(robot)
    yield from _limits(robot)
    yield from _frames(robot)
    yield _title("Graph: row = body, column = joint (T: row = joint, column = body)")
    yield from _graph(robot.graph, width)
    yield from _vectors(robot)
    yield from _system(robot, width)


def _heading(robot: RobotDescription) -> str:
    locked = "".join(f", {name} locked at {value:g}" for name, value in robot.locked.items())
    return (
        f"{robot.robot}: {len(robot.bodies)} bodies on {len(robot.joints)} joints{locked}\n"
        f"total mass {robot.total_mass:.6g} kg, gravity {vector_text(robot.gravity)} m/s², ground '{robot.base}'"
    )


def _title(title: str) -> Text:
    return Text(f"\n{title}", style="bold")


def _table(*columns: str, numbers: Sequence[str] = ()) -> Table:
    """A table whose `numbers` columns are to the right; names fold, so that nothing is lost in 80 characters."""
    table = Table()
    for column in columns:
        table.add_column(column, justify="right" if column in numbers else "left", overflow="fold")
    return table


def _bodies(robot: RobotDescription) -> Iterator[RenderableType]:
    yield _title("Bodies")
    mass, center, moments = "mass\n[kg]", "centre of mass\n[m]", "principal moments\n[kg m²]"
    table = _table("", "name", mass, center, moments, numbers=("", mass, center, moments))
    for body in robot.bodies:
        table.add_row(
            str(body.number),
            body.name,
            f"{body.mass:.4g}",
            vector_text(body.center_of_mass),
            vector_text(body.principal_moments),
        )
    yield table


def _consistency(robot: RobotDescription) -> list[str]:
    """A sentence per body that no real body can be, or one for all."""
    impossible = [body for body in robot.bodies if not body.consistent]
    return [f"not physically consistent: body '{body.name}': {'; '.join(body.problems)}" for body in impossible] or [
        "every body is physically consistent"
    ]


def _joints(robot: RobotDescription) -> Iterator[RenderableType]:
    yield _title("Joints: from body → to body, 0 is the ground")
    table = _table("", "name", "kind", "bodies", "axis", "xyz [m]", "rpy [°]", numbers=("",))
    for joint, edge in zip(robot.joints, robot.model.joints, strict=True):
        table.add_row(
            str(joint.number),
            joint.name,
            joint.kind,
            f"{edge.inside} → {joint.number}",
            vector_text(joint.axis),
            vector_text(joint.xyz),
            vector_text(joint.rpy),
        )
    yield table


def _limits(robot: RobotDescription) -> Iterator[RenderableType]:
    yield _title("Limits [rad or m, …/s, N m or N], damping and friction")
    names = ("lower", "upper", "velocity", "effort", "damping", "friction")
    table = _table("", "name", *names, numbers=("", *names))
    for joint in robot.joints:
        limits = (joint.lower, joint.upper, joint.velocity, joint.effort)
        numbers = ("–" if limit is None else f"{limit:.4g}" for limit in limits)
        table.add_row(str(joint.number), joint.name, *numbers, f"{joint.damping:.4g}", f"{joint.friction:.4g}")
    yield table


def _frames(robot: RobotDescription) -> Iterator[RenderableType]:
    yield _title("Frames" if robot.frames else "No named frames")
    if not robot.frames:
        return
    table = _table("name", "also called", "in body", "xyz [m]", "rpy [°]")
    for frame in robot.frames:
        table.add_row(frame.name, ", ".join(frame.aliases), frame.body, vector_text(frame.xyz), vector_text(frame.rpy))
    yield table


def _graph(graph: GraphRecord, width: int) -> Iterator[RenderableType]:
    blocks = [Text("\n".join([title, *matrix_lines(matrix)])) for title, matrix in graph.matrices.items()]
    if max(len(line) for block in blocks for line in block.plain.splitlines()) > width:
        yield Text(f"the matrices are too wide for {width} characters; --json and --html have them")
    else:
        yield Padding(Columns(blocks, padding=(1, 3)), (1, 0, 0, 0))


def _vectors(robot: RobotDescription) -> Iterator[RenderableType]:
    yield _title("Body-joint vectors C")
    yield Text("S_ij times the way from the centre of mass of body i to joint j, in axes of i")
    table = _table("i", "body", "j", "joint", "S_ij", "C_ij [m]", numbers=("i", "j", "S_ij"))
    graph = robot.graph
    for i, j in np.argwhere(graph.incidence):
        body, joint = robot.bodies[i], robot.joints[j]
        vector = vector_text(graph.body_joint_vectors[i, j])
        table.add_row(str(body.number), body.name, str(joint.number), joint.name, f"{graph.incidence[i, j]:+d}", vector)
    yield table


def _system(robot: RobotDescription, width: int) -> Iterator[RenderableType]:
    system, size = robot.system, len(robot.system.pattern)
    entries = int(system.pattern.sum())
    yield _title(f"Eq. (111), {size}×{size}, at a random state (seed {system.seed}): upper left A, lower left φ_q")
    lines = picture(system.pattern, system.n_bodies, width)
    yield Group(*map(Text, lines)) if lines else Text(f"too wide for {width} characters; --json and --html have it")
    yield Text(
        f"{entries} of {size**2} entries are not zero ({entries / size**2:.1%})\n"
        f"rank {system.rank} of {size}, condition number {system.condition_number:.4g}"
    )
