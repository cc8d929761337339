"""Derivatives of the recursions in the joint variables, by automatic differentiation of what they record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS
from graphdyn.model.coupling import DegreesOfFreedom
from graphdyn.recursions.declarations import ArraySpec, recursion
from graphdyn.recursions.inertia import mass_matrix
from graphdyn.recursions.inverse import Loads, inverse_dynamics
from graphdyn.recursions.loops.couplings import everywhere, projected, solved
from graphdyn.recursions.mechanism.mechanism import Links
from graphdyn.recursions.motion import Root
from graphdyn.recursions.regressors import joint_torque_regressor
from graphdyn.scalars.differentiation import directional, jacobian
from graphdyn.scalars.vectors import PerJoint, Scalars


@recursion(
    dtau_dq=ArraySpec(("n", "n"), "N m, N, N/m"),
    dtau_dv=ArraySpec(("n", "n"), "N m s, N s, N s/m"),
    dtau_da=ArraySpec(("n", "n"), "kg m², kg m, kg"),
)
def inverse_dynamics_derivatives(
    links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint, external: Loads = None
) -> dict[str, Any]:
    """dtau_dq, dtau_dv, and dtau_da = M (n n each)."""
    tau = inverse_dynamics(links, root, q, v, a, external)["tau"]
    by_q, by_v = jacobians(tau, q, v)
    return {"dtau_dq": by_q, "dtau_dv": by_v, "dtau_da": mass_matrix(links, q)}


@recursion(
    d2tau_dqdq=ArraySpec(("n", "n", "n"), "N m, N, N/m, N/m²"),
    d2tau_dqdv=ArraySpec(("n", "n", "n"), "N m s, N s, N s/m, N s/m²"),
    d2tau_dqda=ArraySpec(("n", "n", "n"), "kg m², kg m, kg, kg/m"),
    d2tau_dvdv=ArraySpec(("n", "n", "n"), "kg m², kg m, kg"),
)
def inverse_dynamics_second_derivatives(
    links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint, external: Loads = None
) -> dict[str, Any]:
    """d2tau_dqdq, d2tau_dqdv, d2tau_dqda, d2tau_dvdv (n n n each), by a forward sweep after the reverse one."""
    tau = inverse_dynamics(links, root, q, v, a, external)["tau"]
    by_q, by_v = jacobians(tau, q, v)
    mass = mass_matrix(links, q)

    def changes(first: Scalars, variables: Sequence[Any], symmetric: bool = False) -> Scalars:
        """∂first_ik/∂x_j at (i, j, k); where symmetric in j and k, each pair is computed once."""
        rates = [directional(list(first.ravel()), variables, unit) for unit in np.eye(len(links)).tolist()]
        change = np.moveaxis(np.array(rates, dtype=object).reshape(-1, *first.shape), 0, 1)
        if symmetric:
            for j, k in zip(*np.tril_indices(len(links)), strict=True):
                change[:, j, k] = change[:, k, j]
        return change

    return {
        "d2tau_dqdq": changes(by_q, q, symmetric=True),
        "d2tau_dqdv": changes(by_v, q),
        "d2tau_dqda": changes(mass, q),
        "d2tau_dvdv": changes(by_v, v, symmetric=True),
    }


@recursion(
    **{f"dmultipliers_d{x}": ArraySpec(("bodies", JOINT_CONSTRAINTS, "n"), f"N, N m per {x}") for x in "qva"},
    **{f"dwrenches_d{x}": ArraySpec(("bodies", BODY_DOF, "n"), f"N, N m per {x}") for x in "qva"},
)
def reaction_derivatives(
    links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint, external: Loads = None
) -> dict[str, Any]:
    """Reaction derivatives of multipliers (n 5 n each) and joint wrenches (n 6 n each) by q, v and a."""
    found = inverse_dynamics(links, root, q, v, a, external)
    return {
        f"d{short}_d{name}": part
        for short, answer in (("multipliers", "multipliers"), ("wrenches", "joint_wrenches"))
        for name, part in zip("qva", jacobians(found[answer], q, v, a), strict=True)
    }


@recursion(
    da_dq=ArraySpec(("n", "n"), "1/s², 1/(m s²), m/s²"),
    da_dv=ArraySpec(("n", "n"), "1/s, 1/(m s), m/s"),
    da_dtau=ArraySpec(("n", "n"), "1/(kg m²), 1/(kg m), 1/kg"),
)
def forward_dynamics_derivatives(
    links: Links,
    root: Root,
    q: PerJoint,
    v: PerJoint,
    tau: PerJoint,
    external: Loads = None,
    degrees_of_freedom: DegreesOfFreedom | None = None,
) -> dict[str, Any]:
    """da_dq = -M⁻¹ ∂τ/∂q, da_dv = -M⁻¹ ∂τ/∂v at the accelerations found, and da_dtau = M⁻¹ (n n each); pivots.

    Carpentier and Mansard, "Analytical derivatives of rigid body dynamics algorithms", Robotics: Science and Systems,
    2018. Fewer operations than to differentiate the elimination itself.
    degrees_of_freedom: of a robot with couplings
    """
    inverse, found, pivots = solved(links, root, degrees_of_freedom, q, v, tau, external)
    a = everywhere(found, degrees_of_freedom)
    required = inverse_dynamics(links, root, q, v, a, external)["tau"]
    changes = jacobians(required, q, v, held=a)
    by_q, by_v = (-(inverse @ projected(part, ("n", "n"), degrees_of_freedom)) for part in changes)
    return {"da_dq": by_q, "da_dv": by_v, "da_dtau": inverse, "pivots": pivots}


@recursion(
    forward_dynamics_parameter_derivatives=ArraySpec(("n", "10 bodies"), "rad/s² or m/s² per parameter"),
)
def forward_dynamics_parameter_derivatives(
    links: Links,
    root: Root,
    q: PerJoint,
    v: PerJoint,
    tau: PerJoint,
    external: Loads = None,
    degrees_of_freedom: DegreesOfFreedom | None = None,
) -> dict[str, Any]:
    """∂a/∂π = -M⁻¹ W at the accelerations found (n, 10 bodies); pivots."""
    inverse, found, pivots = solved(links, root, degrees_of_freedom, q, v, tau, external)
    regressor = joint_torque_regressor(links, root, q, v, everywhere(found, degrees_of_freedom))
    change = -(inverse @ projected(regressor, ("n", "10 bodies"), degrees_of_freedom))
    return {"forward_dynamics_parameter_derivatives": change, "pivots": pivots}


@recursion(coriolis_matrix=ArraySpec(("n", "n"), "N m s, N s, kg/s"))
def coriolis_matrix(links: Links, q: PerJoint, v: PerJoint) -> Scalars:
    """C = ½ (Ṁ + B - Bᵀ) with B = ∂(M v)/∂q (n, n)."""
    mass = mass_matrix(links, q)
    rate = np.array(directional(list(mass.ravel()), q, v), dtype=object).reshape(mass.shape)
    change = jacobian(list(mass @ np.array(v, dtype=object)), q)
    matrix: Scalars = (rate + change - change.T) * 0.5
    return matrix


def jacobians(results: Sequence[Any], *variables: Sequence[Any], held: Sequence[Any] = ()) -> list[Scalars]:
    """∂results/∂x (len(results), len(x)) for each x of the variables, in one sweep for all, while others are held."""
    ends = np.cumsum([len(x) for x in variables])[:-1]
    return np.split(jacobian(results, [column for x in variables for column in x], held), ends, axis=1)
