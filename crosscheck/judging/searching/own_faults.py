"""Faults that only one function of the table can have, such as columns of a regressor in another order, or scaled."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from crosscheck.judging.faults.fault import FaultDescription, factor_said, round_factor
from crosscheck.judging.faults.terms import RIGID_BODY_REMEDY
from crosscheck.judging.searching.found_fault import FoundFault
from crosscheck.judging.searching.regressor_columns import MAX_LISTED_COLUMNS, of_base_regressor, of_columns
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS
from crosscheck.quantities.scales import largest
from graphdyn.errors import first_of
from graphdyn.layout import Array

OwnFault = Callable[[Array, Array, JudgedStates, float], FoundFault | None]
"""(answers, graphdyn's, states, bound) → the fault; None if it is none of those known here."""


def _of_velocities_in_symbols(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """The sums over k are of c_ijk and another velocity than v_k."""
    coriolis, scale = FUNCTIONS["coriolis_matrix"], float(np.abs(ours).max()) or 1.0
    units = np.eye(states.model.n_bodies)
    symbols = [coriolis.of_graphdyn(states.but(v=unit + 0 * states.v), {}) for unit in units]  # c_ijk by k
    for k, (name, symbol) in enumerate(zip(states.model.joint_names, symbols, strict=True)):
        left = float(np.abs(answer - ours + states.v[:, k, None, None] * symbol).max()) / scale
        if left <= bound and symbol.any():
            message = f"the velocity of joint '{name}' is left out of the sums over k of c_ijk v_k"
            return FoundFault(FaultDescription("argument", message, "sum over all joints"), left)
    of_columns = np.sum(symbols, axis=0) * states.v[:, None, :]
    left = float(np.abs(answer - of_columns).max()) / scale
    if left <= bound:
        message = "the sums over k are of c_ijk v_j, the velocity of the column, not of c_ijk v_k"
        return FoundFault(FaultDescription("argument", message, "C_ij = Σ_k c_ijk v_k"), left)
    return None


def _of_coriolis_matrix(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """C v is right, which leaves Ṁ - 2C; or the velocity in C is not that of the state."""
    if other := _of_velocities_in_symbols(answer, ours, states, bound):
        return other
    size = np.maximum(largest(ours @ states.v[..., None]), largest(states.mass) * largest(states.v) ** 2)
    left = float((largest((answer - ours) @ states.v[..., None]) / np.where(size > 0, size, 1.0)).max())
    if not left <= bound:
        return None
    message = "C v is right, but C + Cᵀ is not Ṁ: Ṁ - 2C is not skew"
    remedy = "enough for C v + g; laws that need Ṁ - 2C skew, such as passivity, take C of the Christoffel symbols"
    return FoundFault(FaultDescription("not_skew", message, remedy), left)


MIN_BASE_MASS_SHARE = 1e-6
"""Part of the mass of all bodies from which on a further mass is told."""


def _of_center(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """A further mass in the ground is counted: answer (M + m) = ours M + m c, of velocities and Jacobians without c."""
    size = len(answer)
    theirs, here = answer.reshape(size, -1), ours.reshape(size, -1)
    mass, width = sum(body.mass for body in states.model.bodies), theirs.shape[1]
    is_place = ours.ndim == 2 and np.array_equal(ours, states.answer("center_of_mass"))
    place = -np.tile(np.eye(width), (size, 1)) if is_place else None
    columns = [theirs.reshape(-1, 1)] + ([] if place is None else [place])
    target = mass * (here - theirs).ravel()
    found = np.linalg.lstsq(np.hstack(columns), target, rcond=None)[0]
    left = float(np.abs(np.hstack(columns) @ found - target).max() / (mass * np.abs(here).max() or 1.0))
    further = float(found[0])
    if not left <= bound or further < MIN_BASE_MASS_SHARE * mass:
        return None
    at = ""
    if place is not None:
        center = found[1:] / further
        at = f" at ({', '.join(f'{x:.4g}' for x in np.where(np.abs(center) < 1e-9, 0.0, center))}) m"
    message = f"a further mass of {further:.6g} kg{at}, fixed in the ground, is counted, such as that of the base link"
    remedy = "the bodies that move are counted, not what is fixed in the ground"
    return FoundFault(FaultDescription("fixed_link", message, remedy, 2), left)


def _of_mass_matrix(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    added = _of_every_column("gravity_torque", answer, ours, states, bound)
    return added or _of_rows(answer, ours, states, bound)


def _of_every_column(at_rest: str, answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """One vector is added to every column: what belongs to no acceleration. at_rest: the function that gives it"""
    added = answer - ours
    vector = added[..., :1]
    left = float(np.abs(added - vector).max() / (np.abs(ours).max() or 1.0))
    if not left <= bound:
        return None
    gravity = FUNCTIONS[at_rest].of_graphdyn(states.but(v=0 * states.v, a=0 * states.a), {})[..., None]
    is_gravity = np.abs(vector - gravity).max() <= bound * np.abs(gravity).max()
    what = "that of gravity" if is_gravity else "one vector, such as a bias or a constant load,"
    message = f"{what} is added to every column: it is not subtracted from the answers to unit accelerations"
    remedy = "subtract the answers at no acceleration from those at unit accelerations"
    return FoundFault(FaultDescription("offset", message, remedy), left)


def _of_rows(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """Rows and columns are those of other joints: entry (i, k) is ours at (f(i), f(k))."""
    size, n = float(np.abs(ours).max()), ours.shape[-1]
    theirs, here = (np.diagonal(x, axis1=1, axis2=2) for x in (answer, ours))
    from_joint = np.abs(theirs[:, :, None] - here[:, None, :]).max(axis=0).argmin(axis=1)
    left = np.abs(answer - ours[:, from_joint][:, :, from_joint]).max() / (size or 1.0)
    if not left <= bound or np.array_equal(from_joint, np.arange(n)):
        return None
    names = states.model.joint_names
    moved = [f"'{names[i]}' has that of '{names[k]}'" for i, k in enumerate(from_joint) if i != k]
    message = f"rows and columns are in the order of other joints: {first_of(moved, MAX_LISTED_COLUMNS)}"
    remedy = f"the order here is {', '.join(names)}; count all joints before"
    return FoundFault(FaultDescription("joint_order", message, remedy), float(left))


REGRESSORS_BY_BODY = (
    *("joint_torque_regressor", "body_regressor", "momentum_regressor", "kinetic_energy_regressor"),
    *("potential_energy_regressor", "forward_dynamics_parameter_derivatives"),
)
"""Functions with ten columns for each body."""

ADDED_DERIVATIVES = {
    "dtau_dv": ("friction", "viscous friction", "N m s/rad or N s/m"),
    "dtau_dq": ("spring", "the stiffness of springs", "N m/rad or N/m"),
}
"""What a constant diagonal in a derivative of torques is: kind, words, unit."""


def _of_torque_rates(name: str, answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """A constant diagonal is added, as by friction or springs."""
    added = answer - ours
    diagonal = np.diagonal(added[0])
    left = float(np.abs(added - np.diag(diagonal)).max() / (np.abs(ours).max() or 1.0))
    if not left <= bound or not diagonal.any():
        return _of_symbols(answer, ours, states, bound) if name == "dtau_dv" else None
    kind, what, unit = ADDED_DERIVATIVES[name]
    shown = ", ".join(f"{x:.4g}" for x in np.where(np.abs(diagonal) > bound * np.abs(diagonal).max(), diagonal, 0.0))
    message = f"{what} ({shown}) {unit} per joint is included"
    return FoundFault(FaultDescription(kind, message, RIGID_BODY_REMEDY), left)


def _of_symbols(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """Factors on the terms of the Christoffel symbols, in ∂τ/∂v = 2 C."""
    rest = states.but(v=0 * states.v, a=0 * states.a)
    weight = rest.answer("inverse_dynamics_derivatives").dtau_dq
    units = np.eye(states.model.n_bodies)
    slopes = [
        states.but(v=0 * states.v, a=unit + 0 * states.a).answer("inverse_dynamics_derivatives").dtau_dq - weight
        for unit in units
    ]
    D = np.stack(slopes, axis=2)  # ∂M_ij/∂q_k (N, n, n, n)
    terms = {
        "Σ_k ∂M_ij/∂q_k v_k, the first term of the Christoffel symbols,": np.einsum("nijk,nk->nij", D, states.v),
        "Σ_k ∂M_ik/∂q_j v_k, the second term of the Christoffel symbols,": np.einsum("nikj,nk->nij", D, states.v),
        "-Σ_k ∂M_jk/∂q_i v_k, the last term of the Christoffel symbols,": -np.einsum("njki,nk->nij", D, states.v),
    }
    columns = np.stack([term.ravel() for term in terms.values()], axis=1)
    factors = np.linalg.lstsq(columns, answer.ravel(), rcond=None)[0]
    left = float(np.abs(columns @ factors - answer.ravel()).max() / (np.abs(ours).max() or 1.0))
    found = {name: round_factor(float(x)) for name, x in zip(terms, factors, strict=True)}
    wrong = [factor_said(name, x) for name, x in found.items() if x != 1]
    if not left <= bound or not 0 < len(wrong) < len(terms):
        return None
    remedy = "c_ijk = ½ (∂M_ij/∂q_k + ∂M_ik/∂q_j - ∂M_jk/∂q_i)"
    return FoundFault(FaultDescription("coriolis", "; ".join(wrong), remedy, len(wrong)), left)


def _of_power(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """Each torque is multiplied by the velocity of another joint, or by a speed."""
    tau = states.answer("inverse_dynamics", loaded=True).tau
    left = float(np.abs(answer - tau * np.abs(states.v)).max() / (np.abs(ours).max() or 1.0))
    if left <= bound:
        message = "torques are multiplied by ∣v∣, not v"
        return FoundFault(FaultDescription("sign", message, "keep the signs of the velocities"), left)
    products = tau[:, :, None] * states.v[:, None, :]
    of_joint = np.abs(answer[:, :, None] - products).max(axis=0).argmin(axis=1)
    chosen = np.take_along_axis(products, of_joint[None, :, None], axis=2)[..., 0]
    left = float(np.abs(answer - chosen).max() / (np.abs(ours).max() or 1.0))
    if not left <= bound:
        return None
    names = states.model.joint_names
    moved = [f"'{names[i]}' by that of '{names[k]}'" for i, k in enumerate(of_joint) if i != k]
    message = f"torques are multiplied by the velocity of another joint: {first_of(moved, MAX_LISTED_COLUMNS)}"
    return FoundFault(FaultDescription("joint_order", message, "multiply each by its own velocity"), left)


def _of_placement(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """The position is in another unit of length."""
    theirs, here = answer[:, :3, 3], ours[:, :3, 3]
    factor = round_factor(float((theirs * here).sum() / ((here * here).sum() or 1.0)))
    changed = ours.copy()
    changed[:, :3, 3] *= factor
    scaled = changed.copy()
    scaled[:, 3, 3] = factor
    for made, what in ((changed, "the position"), (scaled, "the whole last column, the 1 below the position too,")):
        left = float(np.abs(answer - made).max() / (np.abs(answer).max() or 1.0))
        if factor != 1 and left <= bound:
            unit = {1000.0: ", as of millimeters", 100.0: ", as of centimeters"}.get(factor, "")
            message = f"{factor_said(what, factor)}{unit}"
            return FoundFault(FaultDescription("unit", message, "give positions in meters"), left)
    return None


def _of_inverse(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """Every entry is inverted by itself, a small number added before or not."""
    if rows := _of_rows(answer, ours, states, bound):
        return rows
    with np.errstate(divide="ignore", invalid="ignore"):
        added = 1 / answer - states.mass
    left = float(np.ptp(added) / np.abs(states.mass).max()) if np.isfinite(added).all() else np.inf
    if not left <= bound:
        return None
    number = float(added.mean())
    shown = f", {number:.4g} added to it" if abs(number) > bound * np.abs(states.mass).max() else ""
    message = f"every entry of the mass matrix is inverted by itself{shown}"
    return FoundFault(FaultDescription("other_function", message, "invert the matrix"), left)


def _of_acceleration_rates(
    name: str, answer: Array, ours: Array, states: JudgedStates, bound: float
) -> FoundFault | None:
    """The same in the torques that the derivatives of accelerations need, −M ∂a."""
    return _of_torque_rates(name, -states.mass @ answer, -states.mass @ ours, states, bound)


OWN_FAULTS: Mapping[str, OwnFault] = {
    **dict.fromkeys(REGRESSORS_BY_BODY, of_columns),
    "base_regressor": of_base_regressor,
    "coriolis_matrix": _of_coriolis_matrix,
    "center_of_mass": _of_center,
    "center_of_mass_jacobian": _of_center,
    "center_of_mass_velocity": _of_center,
    "dtau_dq": partial(_of_torque_rates, "dtau_dq"),
    "dtau_dv": partial(_of_torque_rates, "dtau_dv"),
    "da_dq": partial(_of_acceleration_rates, "dtau_dq"),
    "da_dv": partial(_of_acceleration_rates, "dtau_dv"),
    "mass_matrix": _of_mass_matrix,
    "mass_matrix_inverse": _of_inverse,
    "dwrenches_da": partial(_of_every_column, "joint_wrenches"),
    "dmultipliers_da": partial(_of_every_column, "multipliers"),
    "power": _of_power,
    "frame_placement": _of_placement,
}
"""Own faults by the name of the function."""
