"""How each error of the cross-check is measured.

Every function returns one relative error per sample (N,): ‖x - reference‖∞ over a scale that cannot vanish.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.quantities.answers import ForwardAnswers, InverseAnswers, PassiveAnswers, SolvedAnswers
from crosscheck.quantities.quantities import BY_NAME, RECURSIVE, kkt_batch
from crosscheck.quantities.scales import (
    acceleration_scale,
    backward_error,
    by_parameter_type,
    by_part,
    center_offset,
    largest,
    largest_tensor,
    ratio,
    relative,
    term_sizes,
)
from crosscheck.quantities.states import Case
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.reference_values import RefereeValues, multipliers_of
from graphdyn import ForwardDynamics, frame_placement, mass_matrix, maximal_state
from graphdyn.equations import link_origins
from graphdyn.layout import Array


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


def passive_errors(case: Case, ours: PassiveAnswers, ref: RefereeValues) -> dict[str, Array]:
    """Errors of the quantities that do not need a regular mass matrix."""
    model, state, loaded = case.model, ours.state, ours.loaded
    assert state.acceleration is not None
    size = term_sizes(model, case.v, case.a, ref.position, ref.velocity, ref.acceleration)
    with_load = size.loaded(case.external_wrenches)
    multipliers = multipliers_of(model, ref.rotation, ref.joint_wrenches)
    offset, tensor = (np.full(len(case.q), size) for size in (center_offset(model), largest_tensor(model)))

    def errors_of(found: InverseAnswers) -> dict[str, Array]:
        inverse = found.inverse
        return {
            "torque": relative(inverse.tau, ref.tau, largest(ref.joint_wrenches), size.spin),
            "joint_wrench": by_part(inverse.joint_wrenches, ref.joint_wrenches, size.force, size.moment),
            "multipliers": relative(inverse.multipliers, multipliers, largest(ref.joint_wrenches)),
            "mass_matrix": relative(found.mass_matrix, ref.mass_matrix, tensor),
            "torque_regressor": by_parameter_type(
                found.torque_regressor, ref.torque_regressor, *size.regressor_columns
            ),
        }

    errors = {
        "link_placement": np.maximum(
            largest(state.rotation - ref.rotation), relative(link_origins(state), ref.position, offset)
        ),
        "link_twist": by_part(state.velocity, ref.velocity, size.velocity, 0 * size.velocity),
        "body_acceleration": by_part(state.acceleration, ref.acceleration, size.acceleration, size.turn),
        **errors_of(ours.usual),
        "torque_external": relative(loaded.tau, ref.tau_external, largest(ref.joint_wrenches_external), size.spin),
        "joint_wrench_external": by_part(
            loaded.joint_wrenches, ref.joint_wrenches_external, with_load.force, with_load.moment
        ),
        "body_regressor": by_parameter_type(
            ours.body_regressor, ref.body_regressor, size.compensated, size.compensated, size.turn
        ),
    }
    if ours.recursive:
        errors |= of_recursive(errors_of(ours.recursive))
    return errors


def of_recursive(errors: Mapping[str, Array]) -> dict[str, Array]:
    """The same errors under the names of the quantities of the recursive method."""
    return {f"{name}{RECURSIVE}": error for name, error in errors.items()}


def torque_errors(ours: PassiveAnswers, referee: PinocchioModel) -> dict[str, Array]:
    """Errors of the quantities that have a verb, on the scale of the largest joint wrench."""
    errors = {}
    for name, answer in ours.of_verbs.items():
        theirs = referee.joint_torques(BY_NAME[name].against, *answer.arguments)
        errors[name] = relative(answer.torques, theirs, largest(answer.joint_wrenches))
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


def forward_errors(
    case: Case, tau: Array, ours: ForwardAnswers, ref: RefereeValues, referee: PinocchioModel
) -> dict[str, Array]:
    """Errors of the quantities solved for accelerations, at the torques tau (N, n).

    referee: gave the reference values ref; it tells the torques that our accelerations need
    """
    model, v, external, loaded = case.model, case.v, case.external_wrenches, ours.dense.loaded
    size = term_sizes(model, v, ref.a, ref.position, ref.velocity, ref.a_body_accelerations)
    bound = acceleration_scale(ref.mass_matrix, ref.a, tau, ref.a_wrenches)
    loads = np.maximum(largest(ref.a_wrenches_external), largest(external))
    moved = term_sizes(model, v, ref.a_external, ref.position, ref.velocity, loaded.body_accelerations)
    with_load = moved.loaded(external)
    bound_loaded = acceleration_scale(ref.mass_matrix, ref.a_external, tau, loads)
    body_bound = model.n_bodies * np.maximum(1.0, size.lever) * bound + largest(ref.a_body_accelerations)
    multipliers = multipliers_of(model, ref.rotation, ref.a_wrenches)

    def backward_errors(found: SolvedAnswers, name: str = "backward_error") -> dict[str, Array]:
        usual, with_loads = found.usual.a, found.loaded.a
        required = referee.inverse_dynamics(case.q, v, usual)
        required_loaded = referee.inverse_dynamics(case.q, v, with_loads, external)
        return {
            name: backward_error(required[0], tau, required[1], ref.mass_matrix, usual),
            f"{name}_external": backward_error(
                required_loaded[0], tau, required_loaded[1], ref.mass_matrix, with_loads, external
            ),
        }

    def solved_errors(found: ForwardDynamics) -> dict[str, Array]:
        moving = largest(found.body_accelerations - ref.a_body_accelerations)
        return {
            "acceleration": ratio(largest(found.a - ref.a), bound),
            "forward_body_acceleration": ratio(moving, body_bound),
            "forward_joint_wrench": by_part(found.joint_wrenches, ref.a_wrenches, size.force, size.moment),
            "forward_multipliers": relative(found.multipliers, multipliers, size.force, size.moment),
        }

    errors = {
        **solved_errors(ours.dense.usual),
        **backward_errors(ours.dense),
        **backward_errors(ours.projected, "backward_error_projected"),
        "acceleration_projected": ratio(largest(ours.projected.usual.a - ref.a), bound),
        "acceleration_external": ratio(largest(loaded.a - ref.a_external), bound_loaded),
        "forward_joint_wrench_external": by_part(
            loaded.joint_wrenches, ref.a_wrenches_external, with_load.force, with_load.moment
        ),
        "dynamics_residual": ours.dynamics_residual,
        "constraint_residual": ours.constraint_residual,
    }
    if ours.recursive:
        errors |= of_recursive(solved_errors(ours.recursive.usual) | backward_errors(ours.recursive))
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


def _range(x: Array) -> tuple[Any, Any]:
    return x.min().item(), x.max().item()
