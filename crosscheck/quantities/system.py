"""The system of equations, Eq. (111), whose solution, rank and conditioning are checked without a reference."""

from __future__ import annotations

import numpy as np

from crosscheck.quantities.scaled_states import ScaledStates
from graphdyn import KKTSolution, KKTSystem, RobotModel, maximal_state
from graphdyn.equations import applied_terms, constraints, mass_terms
from graphdyn.layout import Array


def kkt_batch(model: RobotModel, q: Array, v: Array, tau: Array) -> KKTSystem:
    """Eq. (111) at N states at once."""
    state = maximal_state(model.rooted, q, v)
    phi_q, zeta = constraints(state)
    applied = applied_terms(state, tau, np.zeros((model.n_bodies, 6)))
    return KKTSystem(
        np.broadcast_to(mass_terms(state), (*phi_q.shape[:-2], *phi_q.shape[-1:] * 2)), phi_q, applied, zeta
    )


def kkt_system(states: ScaledStates) -> KKTSystem:
    """Eq. (111) at all states."""
    found: KKTSystem = states.once("Eq. (111)", lambda: kkt_batch(states.model, states.q, states.v, states.tau))
    return found


def solution(states: ScaledStates) -> KKTSolution:
    """Solution of Eq. (111). Raises LinAlgError for an exactly singular system."""
    found: KKTSolution = states.once("solution of Eq. (111)", lambda: kkt_system(states).solve_unchecked())
    return found
