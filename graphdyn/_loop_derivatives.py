"""Derivatives of accelerations and torques of robots with loops, along closed motions.

Accelerations:

    ⎡ M  Jᵀ ⎤ ⎡ da ⎤   ⎡ dτ - d(M a + h + Jᵀλ) ⎤
    ⎣ J  0  ⎦ ⎣ dλ ⎦ = ⎣ d(γ - J a)            ⎦

at fixed a, λ on the right, which complex steps differentiate. Redundant rows do not matter: along closed motions what a
self-stress adds to the right is again of the form Jᵀ y.

Torques at the motors s: τ_s = K_s (K_sᵀ K_s)⁻¹ Kᵀ f of the torques f of the tree, with the motions K of the dependent
joints that graphdyn.kernels.loops has, which are analytic in q; complex steps differentiate the whole.
"""

from __future__ import annotations

import numpy as np

from graphdyn import _projected as projected
from graphdyn._base_motion import BaseMotion
from graphdyn._complex_steps import derivatives
from graphdyn._linear import apply, solve
from graphdyn._loop_dynamics import actuation, closed, response, solved
from graphdyn._model import RobotModel
from graphdyn._projected import Arguments
from graphdyn.layout import Array


def forward_dynamics_derivatives(
    model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False
) -> dict[str, Array]:
    """∂a/∂q, ∂a/∂v, ∂a/∂τ (…, n, n). Raises InconsistentState, SingularMassMatrix."""
    found = solved(model, x, base)
    spaces, to_free = found.held.spaces, response(found.held.spaces, found.mass)
    state = {**x, "a": found.a, "multipliers": found.multipliers}
    answer = {"da_dtau": to_free}
    for name in "qv":
        change = derivatives(_missing, model, state, base, dense, name)
        start = -spaces.inverse_matrix @ change["rows"]
        answer[f"da_d{name}"] = start - to_free @ (change["torque"] + found.mass @ start)
    return answer


def inverse_dynamics_derivatives(
    model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False
) -> dict[str, Array]:
    """∂τ/∂q, ∂τ/∂v, ∂τ/∂a (…, n, n). Raises as graphdyn._loop_dynamics.inverse_dynamics does."""
    actuation(model, closed(model, x["q"], x["v"], x["a"]).spaces)
    return {f"dtau_d{name}": derivatives(_at_motors, model, x, base, dense, name)["tau"] for name in "qva"}


def _at_motors(model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False) -> dict[str, Array]:
    """τ as functions of q, v and a that are analytic, and right where these are closed."""
    jacobian = model.loops.jacobian(model.loops.links(x["q"]))
    dependent = list(model.dependent_joints)
    independent = [j for j in range(model.n_freedoms) if j not in dependent]
    columns = jacobian[..., dependent]
    transposed = np.swapaxes(columns, -1, -2)
    motions = np.zeros((*jacobian.shape[:-2], model.n_freedoms, len(independent)), dtype=jacobian.dtype)
    motions[..., independent, range(len(independent))] = 1.0
    motions[..., dependent, :] = -np.linalg.solve(transposed @ columns, transposed @ jacobian[..., independent])
    motors = [model.independent_joints.index(name) for name in model.actuated or ()]
    of_motors = motions[..., motors, :]
    needed = apply(np.swapaxes(motions, -1, -2), projected.inverse_dynamics(model.opened, x, base)["tau"])
    tau = np.zeros(np.broadcast_shapes(x["q"].shape, (*needed.shape[:-1], model.n_freedoms)), dtype=needed.dtype)
    tau[..., motors] = apply(of_motors, solve(np.swapaxes(of_motors, -1, -2) @ of_motors, needed))
    return {"tau": tau}


def _missing(model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False) -> dict[str, Array]:
    """M a + h + Jᵀλ and J a - γ, at x["a"] and x["multipliers"]."""
    links = model.loops.links(x["q"], x["v"])
    jacobian = model.loops.jacobian(links)
    torque = projected.inverse_dynamics(model.opened, x, base)["tau"]
    return {
        "torque": torque + apply(np.swapaxes(jacobian, -1, -2), x["multipliers"]),
        "rows": apply(jacobian, x["a"]) - model.loops.bias(links),
    }
