"""Computes the description of a robot that `graphdyn show` shows."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from crosscheck.studies.description import (
    BodyRecord,
    FrameRecord,
    GraphRecord,
    JointRecord,
    RobotDescription,
    SystemRecord,
)
from graphdyn import Placement, RobotModel, kkt_system
from graphdyn.layout import BODY_FREEDOMS, JOINT_CONSTRAINTS, Array
from urdf._rpy import rpy_from_rotation

SEED = 0
"""Seed of the random state at which the matrix of Eq. (111) is shown."""

ROUNDING = 1e-14
"""Part of the largest entry of its block (one body or joint by one body or joint) below which an entry is zero."""


def describe(model: RobotModel, robot: str, locked: Mapping[str, float]) -> RobotDescription:
    """Everything about a robot that was loaded under this name with these joints locked."""
    base_xyz, base_rpy = _xyz_rpy(model.base)
    graph = model.graph
    return RobotDescription(
        model=model,
        robot=robot,
        locked=dict(locked),
        base=model.base_name,
        base_xyz=base_xyz,
        base_rpy=base_rpy,
        gravity=model.gravity,
        total_mass=sum(body.mass for body in model.bodies),
        bodies=_bodies(model),
        joints=_joints(model),
        frames=tuple(
            FrameRecord(frame.name, frame.aliases, _vertex(model, frame.body), *_xyz_rpy(frame.placement))
            for frame in model.frames
        ),
        graph=GraphRecord(graph.incidence(), graph.path_matrix(), graph.incidence(), model.body_joint_vectors()),
        system=_system(model),
    )


def _bodies(model: RobotModel) -> tuple[BodyRecord, ...]:
    return tuple(
        BodyRecord(
            number=i,
            name=body.name,
            mass=body.mass,
            center_of_mass=body.center_of_mass,
            principal_moments=np.linalg.eigvalsh(body.inertia).astype(float),
            consistent=verdict.consistent,
            problems=verdict.problems,
        )
        for i, (body, verdict) in enumerate(zip(model.bodies, model.physical_consistency(), strict=True), start=1)
    )


def _joints(model: RobotModel) -> tuple[JointRecord, ...]:
    records = []
    for j, joint in enumerate(model.joints, start=1):
        xyz, rpy = _xyz_rpy(joint.placement)
        records.append(
            JointRecord(
                number=j,
                name=joint.name,
                kind=joint.kind,
                inside=_vertex(model, joint.inside),
                body=_vertex(model, j),
                axis=joint.axis,
                xyz=xyz,
                rpy=rpy,
                lower=joint.limits.lower,
                upper=joint.limits.upper,
                velocity=joint.limits.velocity,
                effort=joint.limits.effort,
                damping=joint.damping,
                friction=joint.friction,
            )
        )
    return tuple(records)


def _system(model: RobotModel) -> SystemRecord:
    q, v = model.random_state(np.random.default_rng(SEED))
    system = kkt_system(model, q, v, np.zeros_like(q))
    rank, size = int(system.rank()), len(system.rhs)
    condition = float(system.condition_number()) if rank == size else np.inf
    return SystemRecord(SEED, q, _pattern(system.matrix), rank, condition)


def _pattern(matrix: Array) -> NDArray[np.bool_]:
    """Entries that are more than the rounding of their block (11n, 11n)."""
    n = len(matrix) // (BODY_FREEDOMS + JOINT_CONSTRAINTS)
    block = np.repeat(np.arange(2 * n), n * [BODY_FREEDOMS] + n * [JOINT_CONSTRAINTS])
    largest = np.zeros((2 * n, 2 * n))
    np.maximum.at(largest, (block[:, None], block), np.abs(matrix))
    pattern: NDArray[np.bool_] = np.abs(matrix) > ROUNDING * largest[block[:, None], block]
    return pattern


def _xyz_rpy(placement: Placement) -> tuple[Array, Array]:
    return placement.translation, np.rad2deg(rpy_from_rotation(placement.rotation))


def _vertex(model: RobotModel, number: int) -> str:
    """Name of a body, or of the ground."""
    return (model.base_name, *model.body_names)[number]
