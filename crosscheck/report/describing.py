"""A robot that was loaded, as the record of `graphdyn show`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from crosscheck.report.describing_loops import describe_loops
from crosscheck.report.describing_parts import placed, vertex
from crosscheck.report.records.show import (
    CouplingRecord,
    FrameRecord,
    GraphRecord,
    JointRecord,
    ShowBodyRecord,
    ShowRecord,
    SystemRecord,
)
from crosscheck.report.records.show_state import StateRecord
from graphdyn import RobotModel, kkt_system
from graphdyn.layout import BODY_FREEDOMS, JOINT_CONSTRAINTS, Array

SEED = 0
"""Seed of the random state at which the matrix of Eq. (111) is shown."""

ROUNDING = 1e-14
"""Part of the largest entry of its block (body, joint, coupling or chord by another) below which an entry is zero."""


def describe(
    model: RobotModel, robot: str, locked: Mapping[str, float], state: StateRecord | None = None
) -> ShowRecord:
    """Everything about a robot that was loaded under this name with these joints locked.

    Raises InconsistentState, naming the loop, where none of many poses closes it.
    """
    base = placed(model.base)
    return ShowRecord(
        robot=robot,
        locked=dict(locked),
        base=model.base_name,
        base_xyz=base["xyz"],
        base_rpy=base["rpy"],
        gravity=model.gravity.tolist(),
        total_mass=sum(body.mass for body in model.bodies),
        bodies=_bodies(model),
        joints=_joints(model),
        couplings=[CouplingRecord(c.joint, dict(c.ratios), c.offset) for c in model.couplings],
        loops=describe_loops(model, None if state is None else np.array(state.q)) if model.chords else None,
        frames=[
            FrameRecord(
                name=frame.name, aliases=frame.aliases, body=vertex(model, frame.body), **placed(frame.placement)
            )
            for frame in model.frames
        ],
        graph=_graph(model),
        system=_system(model),
        state=state,
    )


def _bodies(model: RobotModel) -> list[ShowBodyRecord]:
    return [
        ShowBodyRecord(
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


def _joints(model: RobotModel) -> list[JointRecord]:
    return [
        JointRecord(
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


def _graph(model: RobotModel) -> GraphRecord:
    incidence = model.graph.incidence().tolist()
    return GraphRecord(
        incidence=incidence,
        path=model.graph.path_matrix().tolist(),
        force_element=incidence,
        body_joint_vectors=model.body_joint_vectors().tolist(),
    )


def _system(model: RobotModel) -> SystemRecord:
    q, v = model.random_state(np.random.default_rng(SEED))
    system = kkt_system(model, q, v, np.zeros_like(q))
    rank, size = int(system.rank()), len(system.rhs)
    return SystemRecord(
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
    sizes = n * [BODY_FREEDOMS] + n * [JOINT_CONSTRAINTS] + len(model.couplings) * [1] + of_chords
    block = np.repeat(np.arange(len(sizes)), sizes)
    largest = np.zeros((len(sizes), len(sizes)))
    np.maximum.at(largest, (block[:, None], block), np.abs(matrix))
    pattern: NDArray[np.bool_] = np.abs(matrix) > ROUNDING * largest[block[:, None], block]
    return pattern
