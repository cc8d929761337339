"""The section of `graphdyn show` on the loops of the robot."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from crosscheck.commands.show.description import LoopsDescription, ReactionDescription, RobotDescription
from crosscheck.report.plain_text import ZERO_COMPONENT_SHARE, matrix_lines, vector_text
from crosscheck.report.report import NO_VALUE, Block, Column, Facts, Group, Lines, Row, Section, Table
from graphdyn.model import FORCES, MOMENTS

MAX_SHOWN_STRESSES = 20
"""Self-stresses on terminal and page; of a linkage of 42 loops there are 138."""

MAX_SHOWN_PARTS = 8
"""Largest number of shown parts of one self-stress, the largest first."""

DIRECTIONS = (*FORCES, *MOMENTS)


def loops_section(robot: RobotDescription, loops: LoopsDescription) -> Section:
    blocks: tuple[Block, ...] = (
        Group((_facts(robot, loops),)),
        _chords(robot, loops),
        _ends(loops),
        Lines(tuple(matrix_lines(loops.incidence)), title="incidence of the chords, beside S"),
        _reactions(loops),
        *([_self_stresses(loops)] if loops.self_stresses else []),
    )
    return Section("loops", "Loops", blocks)


def _facts(robot: RobotDescription, loops: LoopsDescription) -> Facts:
    redundant = loops.n_rows - loops.rank
    pose = "a closed one of the robot" if robot.state is None else "the given state"
    singular = "no"
    if loops.singular:
        singular = f"yes: rank {loops.rank}, in a regular pose {loops.usual_rank}; more motions are free here"
    return Facts(
        (
            ("pose", f"{pose}, q = {vector_text(loops.q)}"),
            ("motors", "not known" if loops.actuated is None else ", ".join(loops.actuated)),
            ("rank", f"{loops.rank} of {loops.n_rows} constraint rows; {redundant} depend on the others"),
            ("mobility", f"{loops.mobility}; after Grübler and Kutzbach it would be {loops.grubler_mobility}"),
            ("singular pose", singular),
            ("undetermined", f"{len(loops.undetermined)} of {_number_of_reactions(loops)} components of the reactions"),
        )
    )


def _number_of_reactions(loops: LoopsDescription) -> int:
    return sum(len(reaction.directions) for reaction in loops.reactions)


def _chords(robot: RobotDescription, loops: LoopsDescription) -> Table:
    numbers = {robot.base: 0, **{body.name: body.number for body in robot.bodies}}
    return Table(
        (
            Column("no.", "number"),
            Column("chord", "name"),
            Column("kind"),
            Column("rows", "number"),
            Column("bodies", meaning="body i – body j, 0 is the ground"),
            Column("closes the loop of joints"),
        ),
        tuple(
            Row(
                (
                    f"c{c.number}",
                    c.name,
                    c.kind,
                    len(c.rows),
                    f"{numbers[c.body_i]} – {numbers[c.body_j]}",
                    ", ".join(c.joints),
                )
            )
            for c in loops.chords
        ),
        title="Chords",
        caption="body i – body j, 0 is the ground",
    )


def _ends(loops: LoopsDescription) -> Table:
    rows = []
    for c in loops.chords:
        of_both = (c.axis if c.kind in ("hinge", "slide") else None, c.length)
        rows.append(Row((f"c{c.number}", c.body_i, c.xyz_i, c.rpy_i, *of_both)))
        rows.append(Row((f"c{c.number}", c.body_j, c.xyz_j, c.rpy_j, *of_both)))
    return Table(
        (
            Column("no.", "number"),
            Column("body", "name"),
            Column("xyz", "vector", "m", vector_text),
            Column("rpy", "vector", "°", vector_text),
            Column("axis", "vector", form=vector_text),
            Column("length", "number", "m", ".4g"),
        ),
        tuple(rows),
        title="Frames of the chords on their two bodies",
    )


def _reactions(loops: LoopsDescription) -> Table:
    missing = "" if loops.reactions_missing is None else f". No numbers: {loops.reactions_missing}"
    return Table(
        (Column("joint or chord", "name"), *(Column(name, "text", form=str) for name in DIRECTIONS)),
        tuple(Row((reaction.name, *_cells(reaction, loops.reactions_missing is None))) for reaction in loops.reactions),
        title="Reactions at rest against gravity",
        caption="N, N m, on the body, or body j, at the joint along its t1, t2, p; an empty cell: nothing determines it"
        + missing,
        compact=True,
    )


def _cells(reaction: ReactionDescription, known: bool) -> list[str]:
    """A cell for each direction: the number, or that it is determined; empty where it is not."""
    names = ["force p" if name == "tension" else name for name in reaction.directions]
    values = np.array(reaction.values, dtype=float)
    negligible = ZERO_COMPONENT_SHARE * np.nanmax(np.abs(values), initial=0.0)
    cells = dict.fromkeys(DIRECTIONS, NO_VALUE)
    for name, determined, value in zip(names, reaction.determined, values, strict=True):
        number = 0.0 if abs(value) <= negligible else value
        cells[name] = "" if not determined else f"{number:.4g}" if known else "determined"
    return list(cells.values())


def _self_stresses(loops: LoopsDescription) -> Table:
    shown = loops.self_stresses[:MAX_SHOWN_STRESSES]
    left = len(loops.self_stresses) - len(shown)
    return Table(
        (Column("no.", "number"), Column("reactions that hold each other without any load, relative to the largest")),
        tuple(Row((number, _combination(stress))) for number, stress in enumerate(shown, start=1)),
        title="Self-stresses",
        caption=f"{left} more: --json has all" if left else "",
    )


def _combination(stress: Mapping[str, float]) -> str:
    order = sorted(stress, key=lambda name: -abs(stress[name]))
    text = ", ".join(f"{name} {stress[name]:.3g}" for name in order[:MAX_SHOWN_PARTS])
    return text if len(order) <= MAX_SHOWN_PARTS else f"{text}, {len(order) - MAX_SHOWN_PARTS} more"
