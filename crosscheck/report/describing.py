"""A robot that was loaded, as the record of `graphdyn show`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.report.records.show import (
    CouplingRecord,
    FrameRecord,
    GraphRecord,
    JointRecord,
    ShowBodyRecord,
    ShowRecord,
    StateRecord,
    SystemRecord,
)
from graphdyn import Placement, RobotModel, kkt_system
from graphdyn.layout import BODY_FREEDOMS, JOINT_CONSTRAINTS, Array
from urdf._rpy import rpy_from_rotation

SEED = 0
"""Seed of the random state at which the matrix of Eq. (111) is shown."""

ROUNDING = 1e-14
"""Part of the largest entry of its block (one body or joint by one body or joint) below which an entry is zero."""


def describe(
    model: RobotModel, robot: str, locked: Mapping[str, float], state: StateRecord | None = None
) -> ShowRecord:
    """Everything about a robot that was loaded under this name with these joints locked."""
    base = _placed(model.base)
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
        frames=[
            FrameRecord(
                name=frame.name, aliases=frame.aliases, body=_vertex(model, frame.body), **_placed(frame.placement)
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
            inside=_vertex(model, joint.inside),
            body=_vertex(model, j),
            axis=joint.axis.tolist(),
            **_placed(joint.placement),
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
        pattern=["".join("01"[entry] for entry in row) for row in _pattern(system.matrix).astype(int)],
        rank=rank,
        condition_number=float(system.condition_number()) if rank == size else np.inf,
        size=size,
    )


def _pattern(matrix: Array) -> NDArray[np.bool_]:
    """Entries that are more than the rounding of their block (11n + n_couplings, the same)."""
    n = len(matrix) // (BODY_FREEDOMS + JOINT_CONSTRAINTS)
    couplings = len(matrix) - n * (BODY_FREEDOMS + JOINT_CONSTRAINTS)
    sizes = n * [BODY_FREEDOMS] + n * [JOINT_CONSTRAINTS] + couplings * [1]
    block = np.repeat(np.arange(len(sizes)), sizes)
    largest = np.zeros((len(sizes), len(sizes)))
    np.maximum.at(largest, (block[:, None], block), np.abs(matrix))
    pattern: NDArray[np.bool_] = np.abs(matrix) > ROUNDING * largest[block[:, None], block]
    return pattern


def _placed(placement: Placement) -> dict[str, Any]:
    """The fields xyz [m] and rpy [degree] of a placement."""
    rpy = np.rad2deg(rpy_from_rotation(placement.rotation))
    return {"xyz": placement.translation.tolist(), "rpy": rpy.tolist()}


def _vertex(model: RobotModel, number: int) -> str:
    """Name of a body, or of the ground."""
    return (model.base_name, *model.body_names)[number]
