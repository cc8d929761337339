"""The public verbs. All follow from the maximal-coordinate system: its solution, its null space, its path matrix.

Leading dimensions of the arguments broadcast. Each verb raises InvalidInput for wrong shapes, NaN and infinities.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arrays import joint_arrays, one_state
from graphdyn.base_motion import BaseMotion, rooted_ground
from graphdyn.cardano import cardano_system
from graphdyn.constraints import constraints
from graphdyn.errors import InvalidInput, SingularMassMatrix
from graphdyn.kinematics import (
    MaximalState,
    bias_acceleration,
    null_space,
    project_accelerations,
    state_on,
)
from graphdyn.kkt import Coordinates, KKTSystem
from graphdyn.layout import BODY_FREEDOMS, Array, per_body, per_joint, stacked
from graphdyn.linear import apply, solve
from graphdyn.model import RobotModel
from graphdyn.reactions import in_link_axes, join_reactions, split_reactions, transmitted_wrenches
from graphdyn.unconstrained import actuator_terms, applied_terms, mass_blocks, mass_terms, passive_terms

Method = Literal["projected", "dense"]
METHODS: tuple[Method, ...] = ("projected", "dense")


@dataclass(frozen=True, eq=False)
class ForwardDynamics:
    """Answer of forward_dynamics.

    a: joint accelerations                                  (…, n)     [rad/s² or m/s²]
    body_accelerations: r̈ in world axes, ω̇ in body axes     (…, n, 6)  [m/s², rad/s²]
    multipliers: reaction of the inside body on body j      (…, n, 5)  [N, N m]
    joint_wrenches: force, moment on body j, actuator included, at O_j, in link axes   (…, n, 6)  [N, N m]
    """

    a: Array
    body_accelerations: Array
    multipliers: Array
    joint_wrenches: Array


@dataclass(frozen=True, eq=False)
class InverseDynamics:
    """Answer of inverse_dynamics.

    tau: actuator torques or forces                         (…, n)     [N m or N]
    body_accelerations, multipliers, joint_wrenches: as in ForwardDynamics
    """

    tau: Array
    body_accelerations: Array
    multipliers: Array
    joint_wrenches: Array


def forward_dynamics(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "projected",
) -> ForwardDynamics:
    """All accelerations and all constraint forces, given the actuator torques.

    q, v, tau: joint state and actuator torques             (…, n)     [rad or m, …/s, N m or N]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]
    base: prescribed motion of the base
    method: "dense" solves the 11n equations of Eq. (111) as they stand; "projected" eliminates the multipliers with
        the null space of φ_q (NᵀAN a = …) and reads them off the path matrix: same answer, faster

    Raises SingularMassMatrix where the torques do not determine the accelerations (massless bodies).
    """
    _check_method(method)
    x = joint_arrays(model, base, q=q, v=v, tau=tau, external_wrenches=external_wrenches)
    state = _state(model, base, x["q"], x["v"])
    n, bias = null_space(state), bias_acceleration(model.rooted, x["q"], x["v"], state.ground)
    mass = _projected_mass(state, n)
    _refuse_singular(model, mass)
    if method == "dense":
        solution = _kkt(state, x["tau"], x["external_wrenches"]).solve_unchecked()
        accelerations = per_body(solution.acceleration)
        wrenches = join_reactions(state, solution.multipliers, x["tau"])
        a = project_accelerations(state, accelerations, bias)
        return ForwardDynamics(a, accelerations, solution.multipliers, in_link_axes(state, wrenches))
    passive = passive_terms(state, x["external_wrenches"])
    free = _inertial_terms(state, bias) - passive
    right = x["tau"] - apply(np.swapaxes(n, -1, -2), stacked(free))
    a = solve(mass, right)
    accelerations = bias + per_body(apply(n, a))
    wrenches = transmitted_wrenches(state, _inertial_terms(state, accelerations) - passive)
    multipliers, _ = split_reactions(state, wrenches)
    return ForwardDynamics(a, accelerations, multipliers, in_link_axes(state, wrenches))


def inverse_dynamics(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    method: Method = "projected",
) -> InverseDynamics:
    """Actuator torques and all constraint forces, given the joint accelerations.

    q, v, a: joint state and accelerations                  (…, n)     [rad or m, …/s, …/s²]
    external_wrenches: force, moment on each body at O_j, in link axes   (…, n, 6)  [N, N m]
    base: prescribed motion of the base
    method: "dense" solves E τ - φ_qᵀλ = A q̈ - B for the 6n unknowns (τ, λ); "projected" sums the wrenches outside
        each joint with the path matrix: same answer, faster
    """
    _check_method(method)
    x = joint_arrays(model, base, q=q, v=v, a=a, external_wrenches=external_wrenches)
    state = _state(model, base, x["q"], x["v"], x["a"])
    assert state.acceleration is not None
    accelerations = np.broadcast_to(state.acceleration, state.velocity.shape)
    required = _inertial_terms(state, accelerations) - passive_terms(state, x["external_wrenches"])
    if method == "dense":
        phi_q, _ = constraints(state)
        matrix = np.concatenate([actuator_terms(state), -np.swapaxes(phi_q, -1, -2)], axis=-1)
        unknowns = solve(matrix, stacked(required))
        tau = unknowns[..., : model.n_bodies]
        multipliers = per_joint(unknowns[..., model.n_bodies :])
        wrenches = join_reactions(state, multipliers, tau)
    else:
        wrenches = transmitted_wrenches(state, required)
        multipliers, tau = split_reactions(state, wrenches)
    return InverseDynamics(tau, accelerations, multipliers, in_link_axes(state, wrenches))


def mass_matrix(model: RobotModel, q: ArrayLike, *, base: BaseMotion | None = None) -> Array:
    """M = NᵀAN (…, n, n) [kg m², kg m, kg]. The motion of a base does not change it; all verbs take the keyword."""
    x = joint_arrays(model, base, q=q)
    state = _state(model, base, x["q"], np.zeros_like(x["q"]))
    return _projected_mass(state, null_space(state))


def bias_torque(model: RobotModel, q: ArrayLike, v: ArrayLike, *, base: BaseMotion | None = None) -> Array:
    """h (…, n): τ = M a + h without external wrenches: velocity, gravity and base motion [N m or N]."""
    return inverse_dynamics(model, q, v, np.zeros(model.n_bodies), base=base).tau


def kkt_system(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    external_wrenches: ArrayLike | None = None,
    *,
    base: BaseMotion | None = None,
    coordinates: Coordinates = "twist",
) -> KKTSystem:
    """Eq. (111) at ONE state: matrix (11n, 11n), right side, rank, condition number, solution, residuals.

    q, v, tau: (n,); external_wrenches: (n, 6); base: prescribed motion of the base at that state
    coordinates: "twist" (r̈, ω̇), regular in every pose; "cardano" (r̈, θ̈) as the paper writes it, rows times Dᵀ

    Raises InvalidInput for more than one state; GimbalLock for Cardano coordinates at |cos β| below 1e-4.
    """
    if coordinates not in ("twist", "cardano"):
        raise InvalidInput(f"coordinates is '{coordinates}'; use 'twist' or 'cardano'")
    x = one_state(model, base, q=q, v=v, tau=tau, external_wrenches=external_wrenches)
    state = _state(model, base, x["q"], x["v"])
    system = _kkt(state, x["tau"], x["external_wrenches"])
    return system if coordinates == "twist" else cardano_system(state, system)


def _state(model: RobotModel, base: BaseMotion | None, q: Array, v: Array, a: Array | None = None) -> MaximalState:
    """The maximal state, shifted so that joint 1 is at the world's origin (RobotModel.rooted)."""
    return state_on(rooted_ground(model, base, q.shape[:-1]), model.rooted, q, v, a)


def _kkt(state: MaximalState, tau: Array, external_wrenches: Array) -> KKTSystem:
    phi_q, zeta = constraints(state)
    return KKTSystem(mass_terms(state), phi_q, applied_terms(state, tau, external_wrenches), zeta)


def _inertial_terms(state: MaximalState, accelerations: Array) -> Array:
    """A q̈ per body (…, n, 6)."""
    return np.einsum("iab,...ib->...ia", mass_blocks(state), accelerations)


def _projected_mass(state: MaximalState, n: Array) -> Array:
    blocks = n.reshape(*n.shape[:-2], state.model.n_bodies, BODY_FREEDOMS, n.shape[-1])
    mass = np.einsum("...iak,iab,...ibl->...kl", blocks, mass_blocks(state), blocks, optimize=True)
    return (mass + np.swapaxes(mass, -1, -2)) / 2


def _check_method(method: str) -> None:
    if method not in METHODS:
        raise InvalidInput(f"method is '{method}'; use one of {', '.join(METHODS)}")


def singular(mass: Array) -> NDArray[np.bool_]:
    """Which mass matrices (…, n, n) are singular (…): scaled to unit diagonal, an eigenvalue at rounding level."""
    values, _ = _scaled_eigensystem(mass)
    sizes = np.abs(values)
    no_inertia = (np.diagonal(mass, axis1=-2, axis2=-1) == 0).any(axis=-1)
    limit = mass.shape[-1] * np.finfo(float).eps * sizes.max(axis=-1, initial=0.0)
    return np.asarray(no_inertia | (sizes.min(axis=-1, initial=np.inf) <= limit))


def _scaled_eigensystem(mass: Array) -> tuple[Array, Array]:
    diagonal = np.abs(np.diagonal(mass, axis1=-2, axis2=-1))
    scale = np.where(diagonal > 0, diagonal, 1.0) ** -0.5
    values, vectors = np.linalg.eigh(mass * scale[..., :, None] * scale[..., None, :])
    return values, vectors


def _refuse_singular(model: RobotModel, mass: Array) -> None:
    at_fault = singular(mass)
    if not at_fault.any():
        return
    row = tuple(int(k) for k in np.argwhere(at_fault)[0])
    values, vectors = _scaled_eigensystem(mass[row])
    joint = int(np.abs(vectors[:, np.abs(values).argmin()]).argmax())
    massless = [body.name for body in model.bodies if body.mass == 0 or not body.inertia.any()]
    cause = f"bodies without mass or inertia: {', '.join(massless)}" if massless else "see physical_consistency()"
    raise SingularMassMatrix(
        f"the mass matrix of robot '{model.name}' is singular{f' in row {row}' if row else ''}: joint "
        f"'{model.joint_names[joint]}' moves without inertia, so torques do not determine accelerations ({cause})"
    )
