"""Derivatives of the recursions in the joint variables, by automatic differentiation of what they record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from graphdyn.kernels.differentiation import directional, jacobian, substituted
from graphdyn.kernels.expressions import Recorder
from graphdyn.kernels.forward import forward_dynamics
from graphdyn.kernels.inertia import mass_matrix
from graphdyn.kernels.inverse import inverse_dynamics
from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root
from graphdyn.kernels.reactions import Wrench
from graphdyn.kernels.vectors import Scalars, scalars, zeros

Columns = Sequence[Any]


def inverse_dynamics_derivatives(
    links: Sequence[Link], root: Root, q: Columns, v: Columns, a: Columns, external: Sequence[Wrench] | None = None
) -> dict[str, list[Any]]:
    """dtau_dq, dtau_dv, and dtau_da = M (n n each)."""
    tau = inverse_dynamics(links, root, q, v, a, external)["tau"]
    return {"dtau_dq": _flat(tau, q), "dtau_dv": _flat(tau, v), "dtau_da": list(mass_matrix(links, q).ravel())}


def reaction_derivatives(
    links: Sequence[Link], root: Root, q: Columns, v: Columns, a: Columns, external: Sequence[Wrench] | None = None
) -> dict[str, list[Any]]:
    """Of multipliers (n 5 n each) and joint wrenches (n 6 n each) by q, v and a."""
    found = inverse_dynamics(links, root, q, v, a, external)
    return {
        f"d{short}_d{name}": _flat(found[answer], variables)
        for name, variables in (("q", q), ("v", v), ("a", a))
        for short, answer in (("multipliers", "multipliers"), ("wrenches", "joint_wrenches"))
    }


def forward_dynamics_derivatives(
    recorder: Recorder,
    links: Sequence[Link],
    root: Root,
    q: Columns,
    v: Columns,
    tau: Columns,
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """da_dq = -M⁻¹ ∂τ/∂q, da_dv = -M⁻¹ ∂τ/∂v at the accelerations found, and da_dtau = M⁻¹ (n n each); pivots.

    Carpentier and Mansard, "Analytical derivatives of rigid body dynamics algorithms", Robotics: Science and Systems,
    2018. Fewer operations than to differentiate the elimination itself.
    """
    found = forward_dynamics(links, root, q, v, tau, external)
    inverse = mass_matrix_inverse(recorder, links, q)["mass_matrix_inverse"]
    a = recorder.placeholders(len(links))
    required = inverse_dynamics(links, root, q, v, a, external)["tau"]
    held = dict(zip(a, found["a"], strict=True))

    def solved(variables: Columns) -> list[Any]:
        rows = np.array(substituted(_flat(required, variables), held), dtype=object).reshape(len(links), -1)
        return list((-(inverse.reshape(rows.shape) @ rows)).ravel())

    return {"da_dq": solved(q), "da_dv": solved(v), "da_dtau": list(inverse), "pivots": found["pivots"]}


def mass_matrix_inverse(recorder: Recorder, links: Sequence[Link], q: Columns) -> dict[str, Any]:
    """mass_matrix_inverse (n n), by how much forward dynamics at rest answer to each torque; pivots."""
    tau, rest = recorder.placeholders(len(links)), [0.0] * len(links)
    found = forward_dynamics(links, _nowhere(), q, rest, tau)
    rows = jacobian(found["a"], tau)
    upper = [[rows[min(i, k), max(i, k)] for k in range(len(links))] for i in range(len(links))]
    return {"mass_matrix_inverse": np.array(upper, dtype=object).ravel(), "pivots": found["pivots"]}


def coriolis_matrix(links: Sequence[Link], q: Columns, v: Columns) -> Scalars:
    """C = ½ (Ṁ + B - Bᵀ) with B = ∂(M v)/∂q (n, n)."""
    mass = mass_matrix(links, q)
    rate = np.array(directional(list(mass.ravel()), q, v), dtype=object).reshape(mass.shape)
    change = jacobian(list(mass @ np.array(v, dtype=object)), q)
    matrix: Scalars = (rate + change - change.T) * 0.5
    return matrix


def _flat(results: Columns, variables: Columns) -> list[Any]:
    return list(jacobian(results, variables).ravel())


def _nowhere() -> Root:
    """A ground at rest without gravity."""
    return Root(
        rotation=scalars(np.eye(3)),
        position=zeros(3),
        gravity=zeros(3),
        velocity=zeros(3),
        omega=zeros(3),
        alpha=zeros(3),
        acceleration=zeros(3),
        compensated=zeros(3),
    )
