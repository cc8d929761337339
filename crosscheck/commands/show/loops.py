"""The loops of a robot: what `graphdyn show` finds, and the section that says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.commands.show.state import rpy_in_degrees
from crosscheck.report.plain_text import ZERO_COMPONENT_SHARE, matrix_lines, vector_text
from crosscheck.report.report import NO_VALUE, Block, Column, Facts, Group, Lines, Row, Section, Table
from graphdyn import Chord, InconsistentState, InvalidInput, LoopAnalysis, RobotModel, analyze_loops, inverse_dynamics
from graphdyn.layout import Array
from graphdyn.model import FORCES, MOMENTS

MAX_SHOWN_STRESSES = 20
"""Self-stresses on terminal and page; of a linkage of 42 loops there are 138."""

MAX_SHOWN_PARTS = 8
"""Largest number of shown parts of one self-stress, the largest first."""

DIRECTIONS = (*FORCES, *MOMENTS)


@dataclass(frozen=True, eq=False)
class ReactionDescription:
    """What one joint or chord transmits: from the inside body to its body, from body i to body j.

    name: of the joint or chord
    directions: such as force t1, along t_1, t_2, p of the joint or chord
    determined: the equations determine this component      (k,)
    values: with the robot at rest, held by its motors against gravity; NaN where undetermined, and where motors are
        unknown or leave a motion free (k,) [N or N m]
    """

    name: str
    directions: Sequence[str]
    determined: NDArray[np.bool_]
    values: Array


@dataclass(frozen=True, eq=False)
class LoopsDescription:
    """The loops of a robot at one closed pose.

    q: the pose, closed: that of --state, or the robot's own (nv,) [rad or m]
    reactions: of all joints, then of all chords
    reactions_missing: why the reactions have no values; None where they have
    """

    model: RobotModel
    q: Array
    analysis: LoopAnalysis
    reactions: Sequence[ReactionDescription]
    reactions_missing: str | None

    @property
    def incidence(self) -> NDArray[np.int_]:
        """Columns of the chords beside S (n, n_chords): 1 for body i, as for an inside body, -1 for body j."""
        with_ground = np.zeros((self.model.n_bodies + 1, len(self.model.chords)), dtype=int)
        for k, chord in enumerate(self.model.chords):
            with_ground[chord.body_i, k], with_ground[chord.body_j, k] = 1, -1
        return with_ground[1:]

    @property
    def undetermined(self) -> list[str]:
        """Names of the reactions that the equations leave undetermined, such as "elbow force p"."""
        return [
            f"{reaction.name} {direction}"
            for reaction in self.reactions
            for direction, known in zip(reaction.directions, reaction.determined, strict=True)
            if not known
        ]

    def joints(self, chord: Chord) -> list[str]:
        """Names of the joints that form the loop with a chord."""
        paths = self.model.loops.paths
        in_loop = paths[chord.body_i] != paths[chord.body_j]
        return [name for name, member in zip(self.model.joint_names, in_loop, strict=True) if member]


def describe_loops(model: RobotModel, q: Array | None) -> LoopsDescription:
    """The loops at q (n,), or where none is given at the robot's own closed pose.

    Raises InconsistentState, naming the loop, where one is open.
    """
    pose = model.closed_pose if q is None else q
    found = analyze_loops(model, pose)
    return LoopsDescription(model, pose, found, *_reactions(model, found, pose))


def _reactions(model: RobotModel, found: LoopAnalysis, q: Array) -> tuple[list[ReactionDescription], str | None]:
    """What joints and chords transmit at rest, and why there are no values."""
    zero = np.zeros_like(q)
    missing = None
    try:
        answer = inverse_dynamics(model, q, zero, zero)
    except (InvalidInput, InconsistentState) as error:  # motors unknown or too few, or infinitesimal mobility
        joints, chords = np.full((model.n_bodies, 6), np.nan), np.full(model.n_chord_rows, np.nan)
        missing = str(error)
    else:
        joints, chords = answer.joint_wrenches, answer.chord_multipliers
    reactions = [
        ReactionDescription(name, DIRECTIONS, known, values)
        for name, known, values in zip(model.joint_names, found.determined_wrenches, joints, strict=True)
    ]
    first = 0
    for chord in model.chords:
        own = slice(first, first := first + len(chord.rows))
        known = found.determined_chord_multipliers[own]
        reactions.append(ReactionDescription(chord.name, chord.rows, known, chords[own]))
    return reactions, missing


def loops_section(loops: LoopsDescription, *, given: bool) -> Section:
    """given: the pose is that of --state"""
    blocks: tuple[Block, ...] = (
        Group((_facts(loops, given),)),
        _chords(loops),
        _ends(loops),
        Lines(tuple(matrix_lines(loops.incidence.tolist())), title="incidence of the chords, beside S"),
        _reactions_table(loops),
        *([_self_stresses(loops.analysis)] if loops.analysis.self_stresses else []),
    )
    return Section("loops", "Loops", blocks)


def _facts(loops: LoopsDescription, given: bool) -> Facts:
    found, motors = loops.analysis, loops.model.actuated
    components = sum(len(reaction.directions) for reaction in loops.reactions)
    singular = "no"
    if found.is_singular:
        singular = f"yes: rank {found.rank}, in a regular pose {found.usual_rank}; more motions are free here"
    also = f", and {found.infinitesimal_mobility} infinitesimal" if found.infinitesimal_mobility else ""
    return Facts(
        (
            ("pose", f"{'the given state' if given else 'a closed one of the robot'}, q = {vector_text(loops.q)}"),
            ("motors", "not known" if motors is None else ", ".join(motors)),
            (
                "rank",
                f"{found.rank} of {found.n_rows} constraint rows; {found.n_rows - found.rank} depend on the others",
            ),
            ("mobility", f"{found.mobility}{also}; after Grübler and Kutzbach it would be {found.grubler_mobility}"),
            ("singular pose", singular),
            ("undetermined", f"{len(loops.undetermined)} of {components} components of the reactions"),
        )
    )


def _chords(loops: LoopsDescription) -> Table:
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
            Row((f"c{k}", c.name, c.kind, len(c.rows), f"{c.body_i} – {c.body_j}", ", ".join(loops.joints(c))))
            for k, c in enumerate(loops.model.chords, start=1)
        ),
        title="Chords",
        caption="body i – body j, 0 is the ground",
    )


def _ends(loops: LoopsDescription) -> Table:
    names = (loops.model.base_name, *loops.model.body_names)
    rows = [
        Row(
            (
                f"c{number}",
                names[body],
                placement.translation,
                rpy_in_degrees(placement),
                chord.axis if chord.kind in ("hinge", "slide") else None,
                chord.length,
            )
        )
        for number, chord in enumerate(loops.model.chords, start=1)
        for body, placement in ((chord.body_i, chord.placement_i), (chord.body_j, chord.placement_j))
    ]
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


def _reactions_table(loops: LoopsDescription) -> Table:
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
    values = reaction.values
    negligible = ZERO_COMPONENT_SHARE * np.nanmax(np.abs(values), initial=0.0)
    cells = dict.fromkeys(DIRECTIONS, NO_VALUE)
    for name, determined, value in zip(names, reaction.determined, values, strict=True):
        number = 0.0 if abs(value) <= negligible else value
        cells[name] = "" if not determined else f"{number:.4g}" if known else "determined"
    return list(cells.values())


def _self_stresses(loops: LoopAnalysis) -> Table:
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
