"""Derivatives of accelerations and torques of robots with loops, along closed motions.

Accelerations:

    ⎡ M  Jᵀ ⎤ ⎡ da ⎤   ⎡ dτ - d(M a + h + Jᵀλ) ⎤
    ⎣ J  0  ⎦ ⎣ dλ ⎦ = ⎣ d(γ - J a)            ⎦

at fixed a, λ on the right, which complex steps differentiate. Redundant rows do not matter: along closed motions what a
self-stress adds to the right is again of the form Jᵀ y.

Torques at the motors s: τ_s = K_s (K_sᵀ K_s)⁻¹ Kᵀ f of the torques f of the tree, with closed motions K that are
analytic in q: combinations of the columns of V of J = U Σ Vᵀ at the pose itself. Complex steps differentiate the whole.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.equations import projected
from graphdyn.equations.complex_steps import derivatives
from graphdyn.equations.loops.dynamics import actuation, closed, response, solved
from graphdyn.equations.specification import Arguments
from graphdyn.layout import Array
from graphdyn.model.spatial import apply, solve


def forward_dynamics_derivatives(x: Arguments) -> dict[str, Array]:
    """∂a/∂q, ∂a/∂v, ∂a/∂τ (…, n, n). Raises InconsistentState, SingularMassMatrix."""
    found = solved(x)
    spaces, to_free = found.held.spaces, response(found.held.spaces, found.mass)
    state = x.but(a=found.a, multipliers=found.multipliers)
    answer = {"da_dtau": to_free}
    for name in "qv":
        change = derivatives(_missing, state, name)
        start = -spaces.inverse_matrix @ change["rows"]
        answer[f"da_d{name}"] = start - to_free @ (change["torque"] + found.mass @ start)
    return answer


def inverse_dynamics_derivatives(x: Arguments) -> dict[str, Array]:
    """∂τ/∂q, ∂τ/∂v, ∂τ/∂a (…, n, n). Raises as graphdyn.equations.loops.dynamics.inverse_dynamics does."""
    spaces = closed(x.model, x["q"], x["v"], x["a"]).spaces
    actuation(x.model, spaces)
    state = x.but(right=spaces.right, free=spaces.free.astype(float))
    return {f"dtau_d{name}": derivatives(_at_motors, state, name)["tau"] for name in "qva"}


def _at_motors(x: Arguments) -> dict[str, Array]:
    """τ as functions of q, v and a that are analytic, and right where these are closed.

    x["right"], x["free"]: V (…, n, n) of J = U Σ Vᵀ at the pose itself, and which of its columns are closed motions
    """
    right, free, eye = x["right"], x["free"][..., None, :], np.eye(x.model.nv)
    loops = x.model.loops
    rows = (loops.jacobian(loops.links(x["q"])) / loops.row_units[:, None]) @ right
    held = rows * (1 - free)
    transposed = np.swapaxes(held, -1, -2)
    motions = right @ (eye * free - np.linalg.solve(transposed @ held + eye * free, transposed @ (rows * free)))
    motors = [x.model.independent_joints.index(name) for name in x.model.actuated or ()]
    units = loops.column_units[motors]
    of_motors = motions[..., motors, :] / units[:, None]
    square = np.swapaxes(of_motors, -1, -2) @ of_motors + eye * (1 - free)
    needed = apply(np.swapaxes(motions, -1, -2), projected.inverse_dynamics(replace(x, model=x.model.opened))["tau"])
    tau = np.zeros(np.broadcast_shapes(x["q"].shape, needed.shape), dtype=needed.dtype)
    tau[..., motors] = apply(of_motors, solve(square, needed)) / units
    return {"tau": tau}


def _missing(x: Arguments) -> dict[str, Array]:
    """M a + h + Jᵀλ and J a - γ, at x["a"] and x["multipliers"]."""
    links = x.model.loops.links(x["q"], x["v"])
    jacobian = x.model.loops.jacobian(links)
    torque = projected.inverse_dynamics(replace(x, model=x.model.opened))["tau"]
    return {
        "torque": torque + apply(np.swapaxes(jacobian, -1, -2), x["multipliers"]),
        "rows": apply(jacobian, x["a"]) - x.model.loops.bias(links),
    }
