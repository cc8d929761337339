"""The loops of a robot, as part of the record of `graphdyn show`."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.report.describing_parts import placed, vertex
from crosscheck.report.records.show_loops import ChordRecord, LoopsRecord, ReactionRecord
from graphdyn import InvalidInput, LoopAnalysis, RobotModel, analyze_loops, inverse_dynamics
from graphdyn._chord import FORCES, MOMENTS
from graphdyn.layout import Array


def describe_loops(model: RobotModel, q: Array | None) -> LoopsRecord:
    """The loops at q (n,), or where none is given at the robot's own closed pose.

    Raises InconsistentState, naming the loop, where one is open.
    """
    pose = model.closed_pose if q is None else q
    found = analyze_loops(model, pose)
    reactions, missing = _reactions(model, found, pose)
    return LoopsRecord(
        chords=_chords(model),
        incidence=_incidence(model).tolist(),
        actuated=model.actuated,
        q=pose.tolist(),
        n_rows=found.n_rows,
        rank=found.rank,
        usual_rank=found.usual_rank,
        singular=found.is_singular,
        mobility=found.mobility,
        grubler_mobility=found.grubler_mobility,
        undetermined=[
            f"{reaction.name} {direction}"
            for reaction in reactions
            for direction, known in zip(reaction.directions, reaction.determined, strict=True)
            if not known
        ],
        self_stresses=found.self_stresses,
        reactions=reactions,
        reactions_missing=missing,
    )


def _chords(model: RobotModel) -> list[ChordRecord]:
    paths = model.loops.paths
    records = []
    for number, chord in enumerate(model.chords, start=1):
        ends: dict[str, Any] = {}
        for end, placement in (("i", chord.placement_i), ("j", chord.placement_j)):
            ends |= {f"{name}_{end}": value for name, value in placed(placement).items()}
        in_loop = paths[chord.body_i] != paths[chord.body_j]
        records.append(
            ChordRecord(
                number=number,
                name=chord.name,
                kind=chord.kind,
                body_i=vertex(model, chord.body_i),
                body_j=vertex(model, chord.body_j),
                axis=chord.axis.tolist(),
                length=chord.length,
                rows=chord.rows,
                joints=[joint.name for joint, member in zip(model.joints, in_loop, strict=True) if member],
                **ends,
            )
        )
    return records


def _incidence(model: RobotModel) -> NDArray[np.int_]:
    """Columns of the chords (n, n_chords), with the signs of S: 1 for body i, as for an inside body, -1 for body j."""
    with_ground = np.zeros((model.n_bodies + 1, len(model.chords)), dtype=int)
    for k, chord in enumerate(model.chords):
        with_ground[chord.body_i, k], with_ground[chord.body_j, k] = 1, -1
    return with_ground[1:]


def _reactions(model: RobotModel, found: LoopAnalysis, q: Array) -> tuple[list[ReactionRecord], str | None]:
    """What joints and chords transmit at rest, and why there are no values."""
    zero = np.zeros_like(q)
    missing = None
    try:
        answer = inverse_dynamics(model, q, zero, zero)
    except InvalidInput as error:  # motors unknown, or too few
        joints, chords = np.full((model.n_bodies, 6), np.nan), np.full(model.n_chord_rows, np.nan)
        missing = str(error)
    else:
        joints, chords = answer.joint_wrenches, answer.chord_multipliers
    records = [
        ReactionRecord(name=name, directions=(*FORCES, *MOMENTS), determined=known.tolist(), values=values.tolist())
        for name, known, values in zip(model.joint_names, found.determined_wrenches, joints, strict=True)
    ]
    first = 0
    for chord in model.chords:
        own = slice(first, first := first + len(chord.rows))
        known, values = found.determined_chord_multipliers[own].tolist(), chords[own].tolist()
        records.append(ReactionRecord(name=chord.name, directions=chord.rows, determined=known, values=values))
    return records, missing
