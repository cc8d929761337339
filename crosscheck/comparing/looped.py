"""Robots with loops: graphdyn's constrained dynamics beside Pinocchio's.

All other quantities are those of the tree, whose joints are free: derivatives, regressors, energies and the rest do not
know of loops in Pinocchio.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import acceleration_scale, largest
from crosscheck.quantities.states import ACCELERATION_RANGE, LOAD, Case
from crosscheck.quantities.tolerances import ACCELERATION, AGREEMENT
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.pinocchio_model.closed import POINT_CHORD_KINDS, closed_dynamics
from graphdyn import (
    InvalidInput,
    Placement,
    RobotModel,
    assemble,
    joint_torques,
)
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model import loop_spaces, rotation_about

MAX_LOOPED_STATES = 20
"""Largest number of states: closing loops takes long, and the other quantities have looked at the tree."""


def why_not_closed(model: RobotModel) -> str | None:
    """Why Pinocchio cannot be asked about these loops."""
    unknown = sorted({chord.kind for chord in model.chords} - set(POINT_CHORD_KINDS))
    if unknown:
        return f"Pinocchio has no constraint for a {' or '.join(unknown)} that keeps its digits"
    return None


def looped_case(model: RobotModel, samples: int, seed: int) -> Case:
    """Random closed states of a robot without couplings, with torques at all joints and loads on the bodies."""
    rng = np.random.default_rng(seed)
    q, v = model.random_state(rng, min(samples, MAX_LOOPED_STATES))
    _, v, a = assemble(model, q, v, rng.uniform(-ACCELERATION_RANGE, ACCELERATION_RANGE, q.shape))
    weight = sum(body.mass for body in model.bodies) * np.linalg.norm(model.gravity)
    wrenches = LOAD * weight * rng.uniform(-1, 1, (len(q), model.n_bodies, 6))
    tau = joint_torques(model.opened, q, v, a) * rng.uniform(0, 2, q.shape)
    return Case("loops", model, Placement(), q, v, a, tau, wrenches)


def looped_errors(case: Case, ours: ScaledStates, pinocchio: PinocchioModel) -> dict[str, Array]:
    """Errors (N,) of each quantity by name. ours: the same states; pinocchio: its model of the tree"""
    model, mass = case.model, ours.mass
    a, wrenches, missing = _closed(case, ours.tau, pinocchio)
    forward = ours.by_methods("forward_dynamics", loaded=True)
    condition = 1 / loop_spaces(model.loops.jacobian(model.loops.links(case.q))).distance  # of rows that hold something
    scale = acceleration_scale(mass, a, ours.tau, wrenches) * condition
    inherited = np.abs(mass).sum(axis=-1).max(axis=-1) * scale * (ACCELERATION.bound / AGREEMENT.bound)
    pins, size = _along_pins(case, wrenches), largest(wrenches) * condition + inherited + missing / AGREEMENT.bound
    determined = [np.nan_to_num(answer.joint_wrenches - pins, nan=0.0) for answer in forward]
    errors = {
        "closed_forward_dynamics": np.maximum.reduce([largest(answer.a - a) / scale for answer in forward]),
        "closed_joint_wrenches": np.maximum.reduce([largest(difference) / size for difference in determined]),
    }
    with suppress(InvalidInput):  # no motors, or motors that leave a motion free
        tau = ours.answer("inverse_dynamics", loaded=True).tau
        moved, _, _ = _closed(case, tau, pinocchio)
        scale = acceleration_scale(mass, case.a, tau, wrenches) * condition
        errors["closed_inverse_dynamics"] = largest(moved - case.a) / scale
    return errors


def _closed(case: Case, tau: Array, pinocchio: PinocchioModel) -> Iterator[Array]:
    """Pinocchio's accelerations (N, n), joint wrenches (N, n, 6) and what is missing of tau (N,)."""
    states = zip(case.q, case.v, tau, case.external_wrenches, strict=True)
    rows = [closed_dynamics(pinocchio, case.model.chords, *state) for state in states]
    return (np.array(column) for column in zip(*rows, strict=True))


def _along_pins(case: Case, wrenches: Array) -> Array:
    """Pinocchio's joint wrenches (N, n, 6), in link axes, along t_1, t_2, p of each joint, fixed in the inside body."""
    model, along = case.model, np.empty_like(wrenches)
    positions = model.joint_positions(case.q)
    for k, joint in enumerate(model.joints):
        triad = np.stack([*joint.axis_normals, joint.axis])
        angle = np.zeros(len(positions)) if joint.is_prismatic else positions[:, k]
        turned = triad @ rotation_about(joint.axis, angle)
        for part in (LINEAR, ANGULAR):
            along[:, k, part] = np.einsum("kab,kb->ka", turned, wrenches[:, k, part])
    return along
