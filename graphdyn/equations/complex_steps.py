"""Derivatives of the plain forms by complex steps, exact to rounding: ∂f/∂x = Im f(x + i h) / h without differences.

Squire and Trapp, "Using complex variables to estimate derivatives of real functions", SIAM Review 40(1), 1998. The
terms of order h² underflow to zero, so that h need not be balanced against rounding.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from graphdyn.equations import frame_motion, projected
from graphdyn.equations.specification import Arguments, Specification
from graphdyn.layout import Array

COMPLEX_STEP_SIZE = 1e-100
"""h: its square underflows beside any term, and h times any term does not."""

STATES_PER_CALL = 1000
"""States whose steps are taken in one call: enough for calls to cost little, few enough for their matrices."""


def derivatives(function: Specification, x: Arguments, name: str) -> Mapping[str, Array]:
    """∂/∂x[name] of all that a specification answers, by name: (…, *answer, n), a column per joint."""
    steps = 1j * COMPLEX_STEP_SIZE * np.eye(x.model.nv)
    count = max(1, x.model.nv * x[name][..., 0].size // STATES_PER_CALL)
    found = [function(_moved(x, name, some)) for some in np.array_split(steps, count)]
    return {
        answer: np.moveaxis(np.concatenate([part[answer].imag for part in found]), 0, -1) / COMPLEX_STEP_SIZE
        for answer in found[0]
    }


def _moved(x: Arguments, name: str, steps: Array) -> Arguments:
    """The arguments at each of the steps (m, n) of x[name], in a new first dimension."""
    copies = {key: np.broadcast_to(array, (len(steps), *array.shape)) for key, array in x.arrays.items()}
    return x.but(**{**copies, name: copies[name] + np.expand_dims(steps, tuple(range(1, x[name].ndim)))})


def inverse_dynamics_derivatives(x: Arguments) -> dict[str, Array]:
    """∂τ/∂q, ∂τ/∂v, ∂τ/∂a of graphdyn.equations.projected.inverse_dynamics."""
    return {f"dtau_d{name}": derivatives(projected.inverse_dynamics, x, name)["tau"] for name in "qva"}


def inverse_dynamics_second_derivatives(x: Arguments) -> dict[str, Array]:
    """∂/∂q and ∂/∂v of ∂τ/∂q, ∂τ/∂v, ∂τ/∂a, by differences that are exact for what these are.

    In an angle: c_0 + Σ (c_k cos kq + s_k sin kq) for k = 1, 2, since a rotation enters a torque at most twice; in a
    slide or a velocity: a parabola, whose slope is the central difference.
    """
    if x.model.couplings:
        joints = {name: x[name] @ x.model.degrees_of_freedom.matrix.T for name in "va"}
        whole = x.but(q=x.model.joint_positions(x["q"]), **joints)
        found = inverse_dynamics_second_derivatives(replace(whole, model=x.model.uncoupled))
        k = x.model.degrees_of_freedom.matrix
        return {name: np.einsum("...ijk,ia,jb,kc->...abc", part, k, k, k) for name, part in found.items()}

    def slopes(name: str, j: int, rule: tuple[Array, Array], of: str) -> list[Array]:
        """∂/∂x[name]_j of ∂τ/∂x for each x of these."""
        steps, weights = rule
        moved = _moved(x, name, np.outer(steps, np.eye(x.model.n_bodies)[j]))
        torques = [derivatives(projected.inverse_dynamics, moved, by)["tau"] for by in of]
        return [np.tensordot(weights, torque, axes=1) for torque in torques]

    turn, slide = _of_trigonometric_sums(order=2), (np.array([1.0, -1.0]), np.array([0.5, -0.5]))
    by_q = [slopes("q", j, slide if joint.is_prismatic else turn, of="qva") for j, joint in enumerate(x.model.joints)]
    by_v = [slopes("v", j, slide, of="v") for j in range(x.model.n_bodies)]
    names, columns = ("d2tau_dqdq", "d2tau_dqdv", "d2tau_dqda"), zip(*by_q, strict=True)
    return {
        **{name: np.stack(parts, axis=-2) for name, parts in zip(names, columns, strict=True)},
        "d2tau_dvdv": np.stack([part for (part,) in by_v], axis=-2),
    }


def _of_trigonometric_sums(order: int) -> tuple[Array, Array]:
    """Steps and weights with f'(x) = Σ weight f(x + step) for all sums of sines and cosines up to this order.

    The derivative of the trigonometric interpolation at equidistant points (Trefethen, Spectral Methods in MATLAB,
    2000, chapter 3).
    """
    count = 2 * order + 1
    steps = 2 * np.pi * np.arange(1, count) / count
    orders = np.arange(1, order + 1)
    weights = 2 / count * np.sin(np.outer(steps, orders)) @ orders
    return steps, weights


def forward_dynamics_derivatives(x: Arguments) -> dict[str, Array]:
    """∂a/∂q, ∂a/∂v, ∂a/∂τ of graphdyn.equations.projected.forward_dynamics. Raises SingularMassMatrix."""
    projected.refuse_singular(x.model, projected.mass_matrix(x)["mass_matrix"])  # names the row of x
    return {f"da_d{name}": derivatives(projected.forward_dynamics, x, name)["a"] for name in ("q", "v", "tau")}


def reaction_derivatives(x: Arguments) -> dict[str, Array]:
    """∂λ and ∂(joint wrenches) by q, v, a of graphdyn.equations.projected.inverse_dynamics."""
    found = {name: derivatives(projected.inverse_dynamics, x, name) for name in "qva"}
    return {
        f"d{short}_d{name}": parts[answer]
        for name, parts in found.items()
        for short, answer in (("multipliers", "multipliers"), ("wrenches", "joint_wrenches"))
    }


def frame_jacobian_derivative(x: Arguments) -> dict[str, Array]:
    """dJ/dt = Σ ∂J/∂q_k v_k: one step along v."""
    stepped = frame_motion.frame_jacobian(x.but(q=x["q"] + 1j * COMPLEX_STEP_SIZE * x["v"]))
    return {"frame_jacobian_derivative": stepped["frame_jacobian"].imag / COMPLEX_STEP_SIZE}


def coriolis_matrix(x: Arguments) -> dict[str, Array]:
    """C_ij = Σ_k ½ (∂M_ij/∂q_k + ∂M_ik/∂q_j - ∂M_jk/∂q_i) v_k."""
    change = derivatives(projected.mass_matrix, x, "q")["mass_matrix"]  # (…, i, j, k)
    christoffel = (change + np.swapaxes(change, -1, -2) - np.moveaxis(change, -1, -3)) / 2
    return {"coriolis_matrix": np.einsum("...ijk,...k->...ij", christoffel, x["v"])}
