"""Functions that answer derivatives in the joint positions and velocities; column k belongs to joint k."""

from __future__ import annotations

import graphdyn
from crosscheck.judging.functions.known_function import Chosen, KnownFunction
from crosscheck.judging.functions.measures import (
    rate_size,
    relative_to,
    through_mass_matrix,
    wrench_size,
)
from crosscheck.judging.states.judged_states import JudgedStates
from graphdyn.layout import BODY_FREEDOMS, JOINT_CONSTRAINTS, Array


def _of_torques(states: JudgedStates) -> graphdyn.InverseDynamicsDerivatives:
    return graphdyn.inverse_dynamics_derivatives(states.model, states.q, states.v, states.a)


def _of_accelerations(states: JudgedStates) -> graphdyn.ForwardDynamicsDerivatives:
    return graphdyn.forward_dynamics_derivatives(states.model, states.q, states.v, states.tau)


def _of_reactions(name: str, size: int) -> KnownFunction:
    """A field of the answer of reaction_derivatives; size: of the reaction of one joint."""

    def ours(states: JudgedStates, chosen: Chosen) -> Array:
        found: Array = getattr(graphdyn.reaction_derivatives(states.model, states.q, states.v, states.a), name)
        return found

    return KnownFunction(
        name, ("q", "v", "a"), ("n", size, "n"), f"N, N m per {name[-1]}",
        ours=ours,
        errors=relative_to(),
        scale="largest entry of the derivatives",
        code=f"graphdyn.reaction_derivatives(model, q, v, a).{name}",
        pinocchio=lambda there, _: there.derived(name),
    )  # fmt: skip


DERIVATIVES = (
    KnownFunction(
        "dtau_dq", ("q", "v", "a"), ("n", "n"), "N m, N, N/m",
        ours=lambda states, _: _of_torques(states).dtau_dq,
        errors=relative_to(wrench_size, lambda states: states.sizes.spin),
        scale="largest entry of the joint wrenches",
        code="graphdyn.inverse_dynamics_derivatives(model, q, v, a).dtau_dq",
        pinocchio=lambda there, _: there.derived("dtau_dq"),
    ),
    KnownFunction(
        "dtau_dv", ("q", "v", "a"), ("n", "n"), "N m s, N s, N s/m",
        ours=lambda states, _: _of_torques(states).dtau_dv,
        errors=relative_to(rate_size),
        scale="largest entry of M × largest velocity",
        code="graphdyn.inverse_dynamics_derivatives(model, q, v, a).dtau_dv",
        pinocchio=lambda there, _: there.derived("dtau_dv"),
    ),
    KnownFunction(
        "da_dq", ("q", "v", "tau"), ("n", "n"), "1/s², 1/(m s²), m/s²",
        ours=lambda states, _: _of_accelerations(states).da_dq,
        errors=through_mass_matrix(wrench_size),
        scale="∣M∣ ∣∂a/∂q∣ and the largest entry of the joint wrenches, of M × the error",
        code="graphdyn.forward_dynamics_derivatives(model, q, v, tau).da_dq",
        pinocchio=lambda there, _: there.derived("da_dq"),
        solves=True,
    ),
    KnownFunction(
        "da_dv", ("q", "v", "tau"), ("n", "n"), "1/s, 1/(m s), m/s",
        ours=lambda states, _: _of_accelerations(states).da_dv,
        errors=through_mass_matrix(rate_size),
        scale="∣M∣ ∣∂a/∂v∣ and the largest entry of M × largest velocity, of M × the error",
        code="graphdyn.forward_dynamics_derivatives(model, q, v, tau).da_dv",
        pinocchio=lambda there, _: there.derived("da_dv"),
        solves=True,
    ),
    *(_of_reactions(f"dmultipliers_d{x}", JOINT_CONSTRAINTS) for x in "qva"),
    *(_of_reactions(f"dwrenches_d{x}", BODY_FREEDOMS) for x in "qva"),
)  # fmt: skip
