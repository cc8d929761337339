"""Derivatives of the plain forms by complex steps, exact to rounding: ∂f/∂x = Im f(x + i h) / h without differences.

Squire and Trapp, "Using complex variables to estimate derivatives of real functions", SIAM Review 40(1), 1998. The
terms of order h² underflow to zero, so that h need not be balanced against rounding.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from graphdyn import _frame_motion as frame_motion
from graphdyn import _projected as projected
from graphdyn._base_motion import BaseMotion
from graphdyn._frame_choice import FrameChoice
from graphdyn._model import RobotModel
from graphdyn._projected import Arguments, Specification
from graphdyn.layout import Array

STEP = 1e-100
"""h: its square underflows beside any term, and h times any term does not."""


def _derivatives(
    function: Specification, model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool, name: str
) -> Mapping[str, Array]:
    """∂/∂x[name] of all that a specification answers, by name: (…, *answer, n), a column per joint."""
    columns = []
    for k in range(model.n_freedoms):
        stepped = x[name].astype(complex)
        stepped[..., k] += 1j * STEP
        columns.append(function(model, {**x, name: stepped}, base, dense))
    return {answer: np.stack([column[answer].imag / STEP for column in columns], axis=-1) for answer in columns[0]}


def inverse_dynamics_derivatives(
    model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False
) -> dict[str, Array]:
    """∂τ/∂q, ∂τ/∂v, ∂τ/∂a of graphdyn._projected.inverse_dynamics."""
    return {
        f"dtau_d{name}": _derivatives(projected.inverse_dynamics, model, x, base, dense, name)["tau"] for name in "qva"
    }


def inverse_dynamics_second_derivatives(
    model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False
) -> dict[str, Array]:
    """∂/∂q and ∂/∂v of ∂τ/∂q, ∂τ/∂v, ∂τ/∂a, by differences that are exact for what these are.

    In an angle: c_0 + Σ (c_k cos kq + s_k sin kq) for k = 1, 2, since a rotation enters a torque at most twice; in a
    slide or a velocity: a parabola, whose slope is the central difference.
    """
    if model.couplings:
        joints = {name: x[name] @ model.freedoms.matrix.T for name in "va"}
        joints |= {"q": model.joint_positions(x["q"]), "external_wrenches": x["external_wrenches"]}
        found = inverse_dynamics_second_derivatives(model.uncoupled, joints, base, dense)
        k = model.freedoms.matrix
        return {name: np.einsum("...ijk,ia,jb,kc->...abc", part, k, k, k) for name, part in found.items()}

    def first(name: str, j: int, step: float) -> dict[str, Array]:
        moved = x[name].copy()
        moved[..., j] += step
        return inverse_dynamics_derivatives(model, {**x, name: moved}, base, dense)

    def slope(name: str, j: int, steps: Sequence[tuple[float, float]]) -> dict[str, Array]:
        terms = [(weight, first(name, j, step)) for step, weight in steps]
        return {answer: np.sum([weight * found[answer] for weight, found in terms], axis=0) for answer in terms[0][1]}

    turn, slide = _of_trigonometric_sums(order=2), [(1.0, 0.5), (-1.0, -0.5)]
    by_q = [slope("q", j, slide if joint.is_prismatic else turn) for j, joint in enumerate(model.joints)]
    by_v = [slope("v", j, slide) for j in range(model.n_freedoms)]
    return {
        "d2tau_dqdq": np.stack([part["dtau_dq"] for part in by_q], axis=-2),
        "d2tau_dqdv": np.stack([part["dtau_dv"] for part in by_q], axis=-2),
        "d2tau_dqda": np.stack([part["dtau_da"] for part in by_q], axis=-2),
        "d2tau_dvdv": np.stack([part["dtau_dv"] for part in by_v], axis=-2),
    }


def _of_trigonometric_sums(order: int) -> list[tuple[float, float]]:
    """Steps and weights with f'(x) = Σ weight f(x + step) for all sums of sines and cosines up to this order.

    The derivative of the trigonometric interpolation at equidistant points (Trefethen, Spectral Methods in MATLAB,
    2000, chapter 3).
    """
    count = 2 * order + 1
    steps = 2 * np.pi * np.arange(1, count) / count
    orders = np.arange(1, order + 1)
    weights = 2 / count * np.sin(np.outer(steps, orders)) @ orders
    return list(zip(steps.tolist(), weights.tolist(), strict=True))


def forward_dynamics_derivatives(
    model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False
) -> dict[str, Array]:
    """∂a/∂q, ∂a/∂v, ∂a/∂τ of graphdyn._projected.forward_dynamics. Raises SingularMassMatrix."""
    return {
        f"da_d{name}": _derivatives(projected.forward_dynamics, model, x, base, dense, name)["a"]
        for name in ("q", "v", "tau")
    }


def reaction_derivatives(
    model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False
) -> dict[str, Array]:
    """∂λ and ∂(joint wrenches) by q, v, a of graphdyn._projected.inverse_dynamics."""
    found = {name: _derivatives(projected.inverse_dynamics, model, x, base, dense, name) for name in "qva"}
    return {
        f"d{short}_d{name}": parts[answer]
        for name, parts in found.items()
        for short, answer in (("multipliers", "multipliers"), ("wrenches", "joint_wrenches"))
    }


def frame_jacobian_derivative(
    model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False, *, frame: FrameChoice
) -> dict[str, Array]:
    """dJ/dt = Σ ∂J/∂q_k v_k: one step along v."""
    stepped = frame_motion.frame_jacobian(model, {"q": x["q"] + 1j * STEP * x["v"]}, base, frame=frame)
    return {"frame_jacobian_derivative": stepped["frame_jacobian"].imag / STEP}


def coriolis_matrix(model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False) -> dict[str, Array]:
    """C_ij = Σ_k ½ (∂M_ij/∂q_k + ∂M_ik/∂q_j - ∂M_jk/∂q_i) v_k."""
    change = _derivatives(projected.mass_matrix, model, x, base, dense, "q")["mass_matrix"]  # (…, i, j, k)
    christoffel = (change + np.swapaxes(change, -1, -2) - np.moveaxis(change, -1, -3)) / 2
    return {"coriolis_matrix": np.einsum("...ijk,...k->...ij", christoffel, x["v"])}
