"""The compared quantities, and how each error is measured (docs/notation.md describes the quantities).

Every function returns one relative error per sample (N,): ‖x - reference‖∞ over a scale that cannot vanish.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import graphdyn
from crosscheck.referee.pinocchio_model import PinocchioModel
from crosscheck.referee.reference_values import RefereeValues
from crosscheck.referee.scales import (
    acceleration_scale,
    by_parameter_type,
    by_part,
    center_offset,
    largest,
    largest_tensor,
    ratio,
    relative,
    term_sizes,
)
from crosscheck.referee.states import Case
from crosscheck.referee.tolerances import (
    ACCELERATION,
    AGREEMENT,
    FORWARD_WRENCH,
    IDENTIFICATION,
    RANK,
    RESIDUAL,
    ROUND_TRIP,
    Tolerance,
)
from graphdyn import (
    ForwardDynamics,
    InverseDynamics,
    RobotModel,
    body_regressor,
    forward_dynamics,
    frame_placement,
    inverse_dynamics,
    joint_torque_regressor,
    mass_matrix,
    maximal_state,
)
from graphdyn._constraints import constraints
from graphdyn._dynamics import VERBS
from graphdyn._kinematics import link_origins
from graphdyn._kkt import KKTSystem
from graphdyn._unconstrained import applied_terms, mass_terms
from graphdyn.layout import ANGULAR, LINEAR, Array


@dataclass(frozen=True)
class Quantity:
    """One row of the table: a quantity, the function of Pinocchio it is compared with, and the bound of its error.

    scale: besides the largest reference value, what the error is relative to, in the terms of docs/notation.md
    forward: whether it needs a regular mass matrix
    verb: the function of graphdyn to compare, where its result is a torque for each joint and Pinocchio's function
        takes the same arguments; both values, scale and code to reproduce then follow from it
    """

    name: str
    against: str
    scale: str
    tolerance: Tolerance
    forward: bool = False
    verb: str | None = None


_PLACED = "rotations: 1; positions: largest position of a link, offset of a center of mass"
_BY_TYPE = "columns of m: compensated × lever; of m c: compensated; of I: turn"
_BY_PART = "forces: force; moments: moment"
_WRENCH = "largest joint wrench"
_TORQUE = "largest joint wrench; spin"
_SOLVED = "only cond(M) ‖a‖ + ‖M⁻¹‖ (‖τ‖ + largest joint wrench)"
_SOLVED_BODIES = "that of acceleration × n × max(1, lever)"
_BASE = "only cond(W) ‖x‖ × rounding of a column, columns of W at unit length"

_PASSIVE = (
    Quantity("link_placement", "forwardKinematics, oMi", _PLACED, AGREEMENT),
    Quantity("frame_placement", "updateFramePlacements, oMf of fused links", _PLACED, AGREEMENT),
    Quantity("link_twist", "forwardKinematics, v", "linear: ‖ω‖ × lever + slide rate", AGREEMENT),
    Quantity("body_acceleration", "forwardKinematics, a", "linear: swing; angular: turn", AGREEMENT),
    Quantity("torque", "rnea", _TORQUE, AGREEMENT),
    Quantity("joint_wrench", "rnea, data.f", _BY_PART, AGREEMENT),
    Quantity("multipliers", "rnea, data.f", _WRENCH, AGREEMENT),
    Quantity("torque_external", "rnea with fext", _TORQUE, AGREEMENT),
    Quantity("joint_wrench_external", "rnea with fext, data.f", _BY_PART, AGREEMENT),
    Quantity("mass_matrix", "crba", "largest entry of a tensor", AGREEMENT),
    Quantity("bias_torque", "nonLinearEffects", _WRENCH, AGREEMENT, verb="bias_torque"),
    Quantity("gravity_torque", "computeGeneralizedGravity", _WRENCH, AGREEMENT, verb="gravity_torque"),
    Quantity("torque_regressor", "computeJointTorqueRegressor", _BY_TYPE, AGREEMENT),
    Quantity("body_regressor", "jointBodyRegressor", "columns of m and m c: compensated; of I: turn", AGREEMENT),
)

_FORWARD = (
    Quantity("acceleration", "aba; ours from the dense system", _SOLVED, ACCELERATION, forward=True),
    Quantity("acceleration_projected", "aba; ours from the null space", _SOLVED, ACCELERATION, forward=True),
    Quantity("acceleration_external", "aba with fext; dense system", _SOLVED, ACCELERATION, forward=True),
    Quantity("forward_body_acceleration", "aba, then a; dense system", _SOLVED_BODIES, ACCELERATION, forward=True),
    Quantity("forward_joint_wrench", "aba, then rnea; dense system", _BY_PART, FORWARD_WRENCH, forward=True),
    Quantity(
        "forward_joint_wrench_external",
        "aba, then rnea, with fext; dense system",
        _BY_PART,
        FORWARD_WRENCH,
        forward=True,
    ),
    Quantity("forward_multipliers", "aba, then rnea; dense system", "force and moment", FORWARD_WRENCH, forward=True),
)

_OWN = (
    Quantity("round_trip", "inverse(forward(τ)) = τ", "τ, joint wrenches, ‖M‖ ‖a‖", ROUND_TRIP, forward=True),
    Quantity("dynamics_residual", "A q̈ + φ_qᵀλ = B", "only the largest row of Σ ∣terms∣", RESIDUAL, forward=True),
    Quantity("constraint_residual", "φ_q q̈ = ζ", "only q̈ and the largest row of Σ ∣terms∣", RESIDUAL, forward=True),
    Quantity("constraint_rank", "φ_q has rank 5n", "full rank", RANK),
    Quantity("kkt_rank", "Eq. (111) has rank 11n", "full rank", RANK, forward=True),
    Quantity("base_parameters", "same least squares with Pinocchio's regressor", _BASE, IDENTIFICATION),
)

RECURSIVE = "_recursive"
"""Ending of the names of quantities that the recursive method computes; compared at random states only."""


def _recursive(rows: Iterable[Quantity], names: set[str]) -> Iterator[Quantity]:
    """The named rows again, for the recursive method; where `against` names our own method, it names this one."""
    for row in rows:
        if row.name in names:
            function, ours, _ = row.against.partition("; ")
            against = f"{function}; ours body after body" if ours else function
            yield replace(row, name=f"{row.name}{RECURSIVE}", against=against)


_PASSIVE_TWICE = {"torque", "joint_wrench", "multipliers", "mass_matrix", "torque_regressor"}
_FORWARD_TWICE = {"acceleration", "forward_body_acceleration", "forward_joint_wrench", "forward_multipliers"}

QUANTITIES = (
    *_PASSIVE,
    *_recursive(_PASSIVE, _PASSIVE_TWICE),
    *_FORWARD,
    *_recursive(_FORWARD, _FORWARD_TWICE),
    *_OWN,
)
BY_NAME = {quantity.name: quantity for quantity in QUANTITIES}


@dataclass(frozen=True)
class Conditioning:
    """Extremes of rank and condition number over the samples of one case: (smallest, largest)."""

    constraint_rank: tuple[int, int]
    constraint_condition: tuple[float, float]
    kkt_rank: tuple[int, int]
    kkt_condition: tuple[float, float]
    mass_matrix_condition: tuple[float, float]

    def merged(self, other: Conditioning) -> Conditioning:
        pairs = ((getattr(self, name), getattr(other, name)) for name in self.__dataclass_fields__)
        return Conditioning(*((min(a[0], b[0]), max(a[1], b[1])) for a, b in pairs))


def passive_errors(case: Case, ref: RefereeValues, *, recursive: bool = False) -> dict[str, Array]:
    """Errors of the quantities that do not need a regular mass matrix; recursive: also of the recursive method."""
    model, q, v, a, external = case.model, case.q, case.v, case.a, case.external_wrenches
    state = maximal_state(model, q, v, a)
    assert state.acceleration is not None
    ours = inverse_dynamics(model, q, v, a)
    loaded = inverse_dynamics(model, q, v, a, external)
    size = term_sizes(model, v, a, ref.position, ref.velocity, ref.acceleration)
    with_load = size.loaded(external)
    multipliers = multipliers_of(model, ref.rotation, ref.joint_wrenches)
    offset, tensor = (np.full(len(q), size) for size in (center_offset(model), largest_tensor(model)))

    def inverse_errors(found: InverseDynamics) -> dict[str, Array]:
        return {
            "torque": relative(found.tau, ref.tau, largest(ref.joint_wrenches), size.spin),
            "joint_wrench": by_part(found.joint_wrenches, ref.joint_wrenches, size.force, size.moment),
            "multipliers": relative(found.multipliers, multipliers, largest(ref.joint_wrenches)),
        }

    def matrix_errors(mass: Array, regressor: Array) -> dict[str, Array]:
        by_type = size.compensated * size.lever, size.compensated, size.turn
        return {
            "mass_matrix": relative(mass, ref.mass_matrix, tensor),
            "torque_regressor": by_parameter_type(regressor, ref.torque_regressor, *by_type),
        }

    errors = {
        "link_placement": np.maximum(
            largest(state.rotation - ref.rotation), relative(link_origins(state), ref.position, offset)
        ),
        "link_twist": by_part(state.velocity, ref.velocity, size.velocity, 0 * size.velocity),
        "body_acceleration": by_part(state.acceleration, ref.acceleration, size.acceleration, size.turn),
        **inverse_errors(ours),
        "torque_external": relative(loaded.tau, ref.tau_external, largest(ref.joint_wrenches_external), size.spin),
        "joint_wrench_external": by_part(
            loaded.joint_wrenches, ref.joint_wrenches_external, with_load.force, with_load.moment
        ),
        **matrix_errors(mass_matrix(model, q), joint_torque_regressor(model, q, v, a)),
        "body_regressor": by_parameter_type(
            body_regressor(model, q, v, a), ref.body_regressor, size.compensated, size.compensated, size.turn
        ),
    }
    if recursive:
        mass = mass_matrix(model, q, method="recursive")
        regressor = joint_torque_regressor(model, q, v, a, method="recursive")
        errors |= _of_recursive(inverse_errors(inverse_dynamics(model, q, v, a, method="recursive")))
        errors |= _of_recursive(matrix_errors(mass, regressor))
    return errors


def _of_recursive(errors: Mapping[str, Array]) -> dict[str, Array]:
    return {f"{name}{RECURSIVE}": error for name, error in errors.items()}


def torque_errors(case: Case, referee: PinocchioModel) -> dict[str, Array]:
    """Errors of the quantities that have a verb, on the scale of the largest joint wrench.

    The wrench is that of inverse dynamics with zero for the velocities and accelerations that the verb does not take.
    """
    errors = {}
    for quantity in QUANTITIES:
        if quantity.verb is not None:
            arguments = [getattr(case, name) for name in VERBS[quantity.verb].inputs]
            ours = getattr(graphdyn, quantity.verb)(case.model, *arguments)
            zeros = [np.zeros_like(case.q)] * (3 - len(arguments))
            wrenches = inverse_dynamics(case.model, *arguments, *zeros).joint_wrenches
            theirs = referee.joint_torques(quantity.against, *arguments)
            errors[quantity.name] = relative(ours, theirs, largest(wrenches))
    return errors


def frame_errors(case: Case, referee: PinocchioModel) -> dict[str, Array]:
    """Errors of the placements of fused links, against Pinocchio's reading of the same file."""
    names = [frame.name for frame in case.model.frames]
    rotation, position = referee.frame_placements(case.q, names)
    ours = [frame_placement(case.model, case.q, name) for name in names]
    turned = largest(np.stack([r for r, _ in ours], axis=1) - rotation)
    links = link_origins(maximal_state(case.model, case.q))
    shifted = relative(
        np.stack([p for _, p in ours], axis=1), position, largest(links), np.full(len(links), center_offset(case.model))
    )
    return {"frame_placement": np.maximum(turned, shifted)}


def forward_errors(case: Case, tau: Array, ref: RefereeValues, *, recursive: bool = False) -> dict[str, Array]:
    """Errors of the quantities solved for accelerations; recursive: also of the recursive method."""
    model, q, v, external = case.model, case.q, case.v, case.external_wrenches
    dense = forward_dynamics(model, q, v, tau, method="dense")
    projected = forward_dynamics(model, q, v, tau)
    loaded = forward_dynamics(model, q, v, tau, external, method="dense")
    back = inverse_dynamics(model, q, v, projected.a)
    solution = kkt_batch(case, tau).solve_unchecked()
    size = term_sizes(model, v, ref.a, ref.position, ref.velocity, ref.a_body_accelerations)
    bound = acceleration_scale(ref.mass_matrix, ref.a, tau, ref.a_wrenches)
    loads = np.maximum(largest(ref.a_wrenches_external), largest(external))
    moved = term_sizes(model, v, ref.a_external, ref.position, ref.velocity, loaded.body_accelerations)
    with_load = moved.loaded(external)
    bound_loaded = acceleration_scale(ref.mass_matrix, ref.a_external, tau, loads)
    body_bound = model.n_bodies * np.maximum(1.0, size.lever) * bound + largest(ref.a_body_accelerations)
    inertial = np.abs(ref.mass_matrix).sum(axis=-1).max(axis=-1) * largest(ref.a)
    multipliers = multipliers_of(model, ref.rotation, ref.a_wrenches)

    def solved_errors(found: ForwardDynamics) -> dict[str, Array]:
        moving = largest(found.body_accelerations - ref.a_body_accelerations)
        return {
            "acceleration": ratio(largest(found.a - ref.a), bound),
            "forward_body_acceleration": ratio(moving, body_bound),
            "forward_joint_wrench": by_part(found.joint_wrenches, ref.a_wrenches, size.force, size.moment),
            "forward_multipliers": relative(found.multipliers, multipliers, size.force, size.moment),
        }

    errors = {
        **solved_errors(dense),
        "acceleration_projected": ratio(largest(projected.a - ref.a), bound),
        "acceleration_external": ratio(largest(loaded.a - ref.a_external), bound_loaded),
        "forward_joint_wrench_external": by_part(
            loaded.joint_wrenches, ref.a_wrenches_external, with_load.force, with_load.moment
        ),
        "round_trip": ratio(
            largest(back.tau - tau), np.maximum.reduce([largest(tau), largest(back.joint_wrenches), inertial])
        ),
        "dynamics_residual": solution.dynamics_residual(),
        "constraint_residual": solution.constraint_residual(),
    }
    if recursive:
        errors |= _of_recursive(solved_errors(forward_dynamics(model, q, v, tau, method="recursive")))
    return errors


def rank_errors(case: Case, tau: Array, regular: NDArray[np.bool_]) -> tuple[dict[str, Array], Conditioning]:
    """Missing ranks of φ_q and of the matrix of Eq. (111), as parts of the full rank, and the conditioning.

    regular: states with a regular mass matrix (N,); only there the matrix of Eq. (111) must have full rank
    """
    system = kkt_batch(case, tau)
    rank, kkt_rank = np.asarray(system.constraint_rank()), np.asarray(system.rank())
    n_rows, size = system.constraint_jacobian.shape[-2], system.matrix.shape[-1]
    errors = {"constraint_rank": 1.0 - rank / n_rows}
    if regular.any():
        errors["kkt_rank"] = np.where(regular, 1.0 - kkt_rank / size, 0.0)
    conditioning = Conditioning(
        _range(rank),
        _range(np.linalg.cond(system.constraint_jacobian)),
        _range(kkt_rank),
        _range(np.asarray(system.condition_number())),
        _range(np.linalg.cond(mass_matrix(case.model, case.q))),
    )
    return errors, conditioning


def kkt_batch(case: Case, tau: Array) -> KKTSystem:
    """Eq. (111) at all states of a case at once."""
    state = maximal_state(case.model.rooted, case.q, case.v)
    phi_q, zeta = constraints(state)
    applied = applied_terms(state, tau, np.zeros((case.model.n_bodies, 6)))
    return KKTSystem(
        np.broadcast_to(mass_terms(state), (*phi_q.shape[:-2], *phi_q.shape[-1:] * 2)), phi_q, applied, zeta
    )


def multipliers_of(model: RobotModel, rotation: Array, wrenches: Array) -> Array:
    """The multipliers (N, n, 5) of a reference implementation's joint wrenches, as docs/notation.md defines them.

    rotation: R_0j of all bodies (N, n, 3, 3); wrenches: at O_j in link axes (N, n, 6)
    """
    force, moment = (np.einsum("...jab,...jb->...ja", rotation, wrenches[..., part]) for part in (LINEAR, ANGULAR))
    result = np.empty((*wrenches.shape[:-1], 5))
    for k, joint in enumerate(model.joints):
        inside = rotation[..., joint.inside - 1, :, :] if joint.inside else model.base.rotation
        t_1, t_2, p = ((inside @ joint.placement.rotation) @ x for x in (*joint.axis_normals, joint.axis))
        f, m = force[..., k, :], moment[..., k, :]
        if joint.is_prismatic:
            rows = [(f * t_1).sum(-1), (f * t_2).sum(-1), (m * t_1).sum(-1), (m * t_2).sum(-1), (m * p).sum(-1)]
        else:
            rows = [f[..., 0], f[..., 1], f[..., 2], (m * t_1).sum(-1), (m * t_2).sum(-1)]
        result[..., k, :] = np.stack(rows, axis=-1)
    return result


def _range(x: Array) -> tuple[Any, Any]:
    return x.min().item(), x.max().item()
