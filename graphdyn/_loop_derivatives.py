"""Derivatives of the accelerations of robots with loops, along closed motions.

    ⎡ M  Jᵀ ⎤ ⎡ da ⎤   ⎡ dτ - d(M a + h + Jᵀλ) ⎤
    ⎣ J  0  ⎦ ⎣ dλ ⎦ = ⎣ d(γ - J a)            ⎦

at fixed a, λ on the right, which complex steps differentiate. Redundant rows do not matter: along closed motions what a
self-stress adds to the right is again of the form Jᵀ y.
"""

from __future__ import annotations

import numpy as np

from graphdyn import _projected as projected
from graphdyn._base_motion import BaseMotion
from graphdyn._complex_steps import derivatives
from graphdyn._linear import apply
from graphdyn._loop_dynamics import response, solved
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


def _missing(model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False) -> dict[str, Array]:
    """M a + h + Jᵀλ and J a - γ, at x["a"] and x["multipliers"]."""
    links = model.loops.links(x["q"], x["v"])
    jacobian = model.loops.jacobian(links)
    torque = projected.inverse_dynamics(model.opened, x, base)["tau"]
    return {
        "torque": torque + apply(np.swapaxes(jacobian, -1, -2), x["multipliers"]),
        "rows": apply(jacobian, x["a"]) - model.loops.bias(links),
    }
