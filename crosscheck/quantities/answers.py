"""What graphdyn answers at the states of one case, to be compared with every route to Pinocchio."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

import graphdyn
from crosscheck.quantities.quantities import QUANTITIES, kkt_batch
from crosscheck.quantities.states import Case
from graphdyn import (
    ForwardDynamics,
    InverseDynamics,
    MaximalState,
    body_regressor,
    forward_dynamics,
    inverse_dynamics,
    joint_torque_regressor,
    mass_matrix,
    maximal_state,
)
from graphdyn.arguments import Method
from graphdyn.layout import Array
from graphdyn.verbs import VERBS


@dataclass(frozen=True, eq=False)
class InverseAnswers:
    """Answers of one method; mass_matrix (N, n, n), torque_regressor (N, n, 10n)."""

    inverse: InverseDynamics
    mass_matrix: Array
    torque_regressor: Array


@dataclass(frozen=True, eq=False)
class VerbAnswer:
    """The answer of a function of graphdyn that gives torques (N, n).

    arguments: q, or q and v, or q, v and a, each (N, n)
    joint_wrenches: of inverse dynamics with zero for the velocities and accelerations that it does not take (N, n, 6)
    """

    arguments: tuple[Array, ...]
    torques: Array
    joint_wrenches: Array


@dataclass(frozen=True, eq=False)
class PassiveAnswers:
    """Answers that do not need a regular mass matrix.

    loaded: inverse dynamics with the external wrenches
    body_regressor: (N, n, 6, 10)
    of_verbs: by the name of the quantity, where it names a verb
    recursive: of the recursive method, where it is compared
    """

    state: MaximalState
    usual: InverseAnswers
    loaded: InverseDynamics
    body_regressor: Array
    of_verbs: Mapping[str, VerbAnswer]
    recursive: InverseAnswers | None


@dataclass(frozen=True, eq=False)
class SolvedAnswers:
    """Forward dynamics of one method: usual, and loaded with the external wrenches."""

    usual: ForwardDynamics
    loaded: ForwardDynamics


@dataclass(frozen=True, eq=False)
class ForwardAnswers:
    """Answers at given torques, which need a regular mass matrix.

    dense, projected, recursive: of these methods; recursive where it is compared
    dynamics_residual, constraint_residual: of the solution of Eq. (111)   (N,)
    """

    dense: SolvedAnswers
    projected: SolvedAnswers
    recursive: SolvedAnswers | None
    dynamics_residual: Array
    constraint_residual: Array


def passive_answers(case: Case, *, recursive: bool = False) -> PassiveAnswers:
    """recursive: also those of the recursive method."""
    model, q, v, a = case.model, case.q, case.v, case.a
    return PassiveAnswers(
        state=maximal_state(model, q, v, a),
        usual=_inverse_answers(case, "auto"),
        loaded=inverse_dynamics(model, q, v, a, case.external_wrenches),
        body_regressor=body_regressor(model, q, v, a),
        of_verbs={quantity.name: _of_verb(case, quantity.verb) for quantity in QUANTITIES if quantity.verb},
        recursive=_inverse_answers(case, "recursive") if recursive else None,
    )


def _inverse_answers(case: Case, method: Method) -> InverseAnswers:
    model, q, v, a = case.model, case.q, case.v, case.a
    return InverseAnswers(
        inverse_dynamics(model, q, v, a, method=method),
        mass_matrix(model, q, method=method),
        joint_torque_regressor(model, q, v, a, method=method),
    )


def _of_verb(case: Case, verb: str) -> VerbAnswer:
    arguments = tuple(getattr(case, name) for name in VERBS[verb].inputs)
    zeros = [np.zeros_like(case.q)] * (3 - len(arguments))
    torques = getattr(graphdyn, verb)(case.model, *arguments)
    return VerbAnswer(arguments, torques, inverse_dynamics(case.model, *arguments, *zeros).joint_wrenches)


def forward_answers(case: Case, tau: Array, *, recursive: bool = False) -> ForwardAnswers:
    """tau: (N, n); recursive: also those of the recursive method. Raises LinAlgError for an exactly singular system."""
    solution = kkt_batch(case, tau).solve_unchecked()
    return ForwardAnswers(
        dense=_solved_answers(case, tau, "dense"),
        projected=_solved_answers(case, tau, "projected"),
        recursive=_solved_answers(case, tau, "recursive") if recursive else None,
        dynamics_residual=solution.dynamics_residual(),
        constraint_residual=solution.constraint_residual(),
    )


def _solved_answers(case: Case, tau: Array, method: Method) -> SolvedAnswers:
    model, q, v = case.model, case.q, case.v
    return SolvedAnswers(
        forward_dynamics(model, q, v, tau, method=method),
        forward_dynamics(model, q, v, tau, case.external_wrenches, method=method),
    )
