"""Robots with couplings: the recursions of all joints, projected onto those that no others drive.

With all joint positions K q + o, torques become Kᵀ τ and Jacobians J K, for any answer that has an entry per joint.
What asks for accelerations solves Kᵀ M K instead of eliminating body after body: a coupling ties joints that are not
neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from graphdyn._coupling import Freedoms
from graphdyn.kernels.derivatives import jacobians
from graphdyn.kernels.differentiation import substituted
from graphdyn.kernels.expressions import Recorder
from graphdyn.kernels.factorization import inverted
from graphdyn.kernels.inertia import mass_matrix
from graphdyn.kernels.inverse import inverse_dynamics
from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root
from graphdyn.kernels.reactions import Wrench
from graphdyn.kernels.regressors import joint_torque_regressor
from graphdyn.kernels.vectors import Scalars, scalars

Columns = Sequence[Any]


def projected(answer: Scalars, shape: Sequence[int | str], freedoms: Freedoms) -> Scalars:
    """An answer of the robot without couplings, with each axis "n" of its shape turned from all joints to the free."""
    for axis, size in enumerate(shape):
        if size == "n":
            answer = np.moveaxis(np.moveaxis(answer, axis, -1) @ scalars(freedoms.matrix), -1, axis)
    return answer


def forward_dynamics(
    links: Sequence[Link],
    root: Root,
    freedoms: Freedoms,
    q: Columns,
    v: Columns,
    tau: Columns,
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """As graphdyn.kernels.forward answers, of q and v of all joints and the torques of the free ones."""
    _, a, pivots = _solved(links, root, freedoms, q, v, tau, external)
    found = inverse_dynamics(links, root, q, v, list(scalars(freedoms.matrix) @ a), external)
    return {**found, "a": list(a), "pivots": pivots}


def mass_matrix_inverse(links: Sequence[Link], freedoms: Freedoms, q: Columns) -> dict[str, Any]:
    """mass_matrix_inverse (n n) and pivots."""
    inverse, pivots = _inverted_mass_matrix(links, freedoms, q)
    return {"mass_matrix_inverse": list(inverse.ravel()), "pivots": pivots}


def forward_dynamics_derivatives(
    recorder: Recorder,
    links: Sequence[Link],
    root: Root,
    freedoms: Freedoms,
    q: Columns,
    v: Columns,
    tau: Columns,
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """As graphdyn.kernels.derivatives answers: -M⁻¹ ∂τ/∂(q, v) at the accelerations found, and M⁻¹ (n n each)."""
    to_joints = scalars(freedoms.matrix)
    inverse, found, pivots = _solved(links, root, freedoms, q, v, tau, external)
    a = recorder.placeholders("a", len(links))
    required = inverse_dynamics(links, root, q, v, a, external)["tau"]
    held = dict(zip(a, to_joints @ found, strict=True))
    by_q, by_v = (
        -(
            inverse
            @ to_joints.T
            @ np.array(substituted(list(part.ravel()), held), object).reshape(part.shape)
            @ to_joints
        )
        for part in jacobians(required, q, v)
    )
    return {
        "da_dq": list(by_q.ravel()),
        "da_dv": list(by_v.ravel()),
        "da_dtau": list(inverse.ravel()),
        "pivots": pivots,
    }


def forward_dynamics_parameter_derivatives(
    links: Sequence[Link],
    root: Root,
    freedoms: Freedoms,
    q: Columns,
    v: Columns,
    tau: Columns,
    external: Sequence[Wrench] | None = None,
) -> dict[str, Any]:
    """∂a/∂π = -M⁻¹ W at the accelerations found (n, 10 bodies); pivots."""
    to_joints = scalars(freedoms.matrix)
    inverse, a, pivots = _solved(links, root, freedoms, q, v, tau, external)
    change = -(inverse @ to_joints.T @ joint_torque_regressor(links, root, q, v, list(to_joints @ a)))
    return {"forward_dynamics_parameter_derivatives": list(change.ravel()), "pivots": pivots}


def power(
    links: Sequence[Link],
    root: Root,
    freedoms: Freedoms,
    q: Columns,
    v: Columns,
    a: Columns,
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """τ_j v_j (n) of the free joints, whose torques move the driven ones too."""
    tau = np.array(inverse_dynamics(links, root, q, v, a, external)["tau"], dtype=object)
    rates = np.array(v, dtype=object)[list(freedoms.independent)]
    return {"power": list(scalars(freedoms.matrix).T @ tau * rates)}


def _solved(
    links: Sequence[Link],
    root: Root,
    freedoms: Freedoms,
    q: Columns,
    v: Columns,
    tau: Columns,
    external: Sequence[Wrench] | None,
) -> tuple[Scalars, Scalars, list[Any]]:
    """M⁻¹ (n, n), a = M⁻¹ (τ - h) (n,), and the pivots (n)."""
    inverse, pivots = _inverted_mass_matrix(links, freedoms, q)
    bias = inverse_dynamics(links, root, q, v, [0.0] * len(links), external)["tau"]
    a = inverse @ (np.array(tau, dtype=object) - scalars(freedoms.matrix).T @ np.array(bias, dtype=object))
    return inverse, a, pivots


def _inverted_mass_matrix(links: Sequence[Link], freedoms: Freedoms, q: Columns) -> tuple[Scalars, list[Any]]:
    """(Kᵀ M K)⁻¹ (n, n), and its pivots (n)."""
    to_joints = scalars(freedoms.matrix)
    mass = to_joints.T @ mass_matrix(links, q) @ to_joints
    return inverted(mass, [range(j)[::-1] for j in range(len(mass))])
