"""What `graphdyn show` says of a robot that was loaded, and of its loops."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.commands.show.description import (
    BodyDescription,
    ChordDescription,
    FrameDescription,
    GraphDescription,
    JointDescription,
    LoopsDescription,
    ReactionDescription,
    RobotDescription,
    StateDescription,
    SystemDescription,
)
from graphdyn import InvalidInput, LoopAnalysis, Placement, RobotModel, analyze_loops, inverse_dynamics, kkt_system
from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS, Array
from graphdyn.model import FORCES, MOMENTS
from urdf.document import rpy_from_rotation


def placed(placement: Placement) -> dict[str, Any]:
    """The fields xyz [m] and rpy [degree] of a placement."""
    rpy = np.rad2deg(rpy_from_rotation(placement.rotation))
    return {"xyz": placement.translation.tolist(), "rpy": rpy.tolist()}


def vertex(model: RobotModel, number: int) -> str:
    """Name of a body, or of the ground."""
    return (model.base_name, *model.body_names)[number]


def describe_loops(model: RobotModel, q: Array | None) -> LoopsDescription:
    """The loops at q (n,), or where none is given at the robot's own closed pose.

    Raises InconsistentState, naming the loop, where one is open.
    """
    pose = model.closed_pose if q is None else q
    found = analyze_loops(model, pose)
    reactions, missing = _reactions(model, found, pose)
    return LoopsDescription(
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


def _chords(model: RobotModel) -> list[ChordDescription]:
    paths = model.loops.paths
    records = []
    for number, chord in enumerate(model.chords, start=1):
        ends: dict[str, Any] = {}
        for end, placement in (("i", chord.placement_i), ("j", chord.placement_j)):
            ends |= {f"{name}_{end}": value for name, value in placed(placement).items()}
        in_loop = paths[chord.body_i] != paths[chord.body_j]
        records.append(
            ChordDescription(
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


def _reactions(model: RobotModel, found: LoopAnalysis, q: Array) -> tuple[list[ReactionDescription], str | None]:
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
    along = (*FORCES, *MOMENTS)
    records = [
        ReactionDescription(name=name, directions=along, determined=known.tolist(), values=values.tolist())
        for name, known, values in zip(model.joint_names, found.determined_wrenches, joints, strict=True)
    ]
    first = 0
    for chord in model.chords:
        own = slice(first, first := first + len(chord.rows))
        known, values = found.determined_chord_multipliers[own].tolist(), chords[own].tolist()
        records.append(ReactionDescription(name=chord.name, directions=chord.rows, determined=known, values=values))
    return records, missing


SEED = 0
"""Seed of the random state at which the matrix of Eq. (111) is shown."""

ZERO_ENTRY_SHARE = 1e-14
"""Part of the largest entry of its block (body, joint, coupling or chord by another) below which an entry is zero."""


def describe(
    model: RobotModel, robot: str, locked: Mapping[str, float], state: StateDescription | None = None
) -> RobotDescription:
    """Everything about a robot that was loaded under this name with these joints locked.

    Raises InconsistentState, naming the loop, where none of many poses closes it.
    """
    base = placed(model.base)
    return RobotDescription(
        robot=robot,
        locked=dict(locked),
        base=model.base_name,
        base_xyz=base["xyz"],
        base_rpy=base["rpy"],
        gravity=model.gravity.tolist(),
        total_mass=sum(body.mass for body in model.bodies),
        bodies=_bodies(model),
        joints=_joints(model),
        couplings=model.couplings,
        loops=describe_loops(model, None if state is None else np.array(state.q)) if model.chords else None,
        frames=[
            FrameDescription(
                name=frame.name, aliases=frame.aliases, body=vertex(model, frame.body), **placed(frame.placement)
            )
            for frame in model.frames
        ],
        graph=_graph(model),
        system=_system(model),
        state=state,
    )


def _bodies(model: RobotModel) -> list[BodyDescription]:
    return [
        BodyDescription(
            number=i,
            name=body.name,
            mass=body.mass,
            center_of_mass=body.center_of_mass.tolist(),
            principal_moments=np.linalg.eigvalsh(body.inertia).tolist(),
            consistent=verdict.consistent,
            problems=verdict.problems,
        )
        for i, (body, verdict) in enumerate(zip(model.bodies, model.physical_consistency(), strict=True), start=1)
    ]


def _joints(model: RobotModel) -> list[JointDescription]:
    return [
        JointDescription(
            number=j,
            name=joint.name,
            kind=joint.kind,
            inside=vertex(model, joint.inside),
            body=vertex(model, j),
            axis=joint.axis.tolist(),
            **placed(joint.placement),
            lower=joint.limits.lower,
            upper=joint.limits.upper,
            velocity=joint.limits.velocity,
            effort=joint.limits.effort,
            damping=joint.damping,
            friction=joint.friction,
        )
        for j, joint in enumerate(model.joints, start=1)
    ]


def _graph(model: RobotModel) -> GraphDescription:
    incidence = model.graph.incidence().tolist()
    return GraphDescription(
        incidence=incidence,
        path=model.graph.path_matrix().tolist(),
        force_element=incidence,
        body_joint_vectors=model.body_joint_vectors().tolist(),
    )


def _system(model: RobotModel) -> SystemDescription:
    q, v = model.random_state(np.random.default_rng(SEED))
    system = kkt_system(model, q, v, np.zeros_like(q))
    rank, size = int(system.rank()), len(system.rhs)
    return SystemDescription(
        seed=SEED,
        q=q.tolist(),
        pattern=["".join("01"[entry] for entry in row) for row in _pattern(system.matrix, model).astype(int)],
        rank=rank,
        condition_number=float(system.condition_number()) if rank == size else np.inf,
        size=size,
    )


def _pattern(matrix: Array, model: RobotModel) -> NDArray[np.bool_]:
    """Entries that are more than the rounding of their block (the shape of the matrix)."""
    n, of_chords = model.n_bodies, [len(chord.rows) for chord in model.chords]
    sizes = n * [BODY_DOF] + n * [JOINT_CONSTRAINTS] + len(model.couplings) * [1] + of_chords
    block = np.repeat(np.arange(len(sizes)), sizes)
    largest = np.zeros((len(sizes), len(sizes)))
    np.maximum.at(largest, (block[:, None], block), np.abs(matrix))
    pattern: NDArray[np.bool_] = np.abs(matrix) > ZERO_ENTRY_SHARE * largest[block[:, None], block]
    return pattern
