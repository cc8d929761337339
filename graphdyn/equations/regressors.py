"""Regressors as the equations read: wrenches, momenta and energies as linear functions of the inertial parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from graphdyn.arguments.base_motion import ground
from graphdyn.equations import projected
from graphdyn.equations.kinematics import MaximalState, null_space, state_on
from graphdyn.equations.specification import Arguments
from graphdyn.layout import ANGULAR, BODY_DOF, BODY_PARAMETERS, LINEAR, Array
from graphdyn.model.spatial import skew


def body_regressor(x: Arguments) -> dict[str, Array]:
    """Y (…, n, 6, 10) at x["q"], x["v"], x["a"]; there are no multipliers that a dense form would solve for."""
    return {"body_regressor": _body_regressor(x.skeleton_state())}


def joint_torque_regressor(x: Arguments) -> dict[str, Array]:
    """W (…, n, 10n): the body regressors projected onto the joints, as the null space projects the body wrenches."""
    state = x.skeleton_state()
    return {"joint_torque_regressor": _projected_blocks(state, _body_regressor(state))}


def forward_dynamics_parameter_derivatives(x: Arguments) -> dict[str, Array]:
    """∂a/∂π = -M⁻¹ W (…, n, 10n), since M ∂a/∂π + W = 0 at fixed τ. Raises SingularMassMatrix."""
    a = projected.forward_dynamics(x)["a"]
    mass = projected.mass_matrix(x)["mass_matrix"]
    torque_per_parameter = joint_torque_regressor(x.but(a=a))["joint_torque_regressor"]
    change = np.asarray(np.linalg.solve(mass, torque_per_parameter), dtype=float)
    return {"forward_dynamics_parameter_derivatives": -change}


def momentum_regressor(x: Arguments) -> dict[str, Array]:
    """(…, n, 10n): the momenta of the bodies, projected onto the joints; M v whatever the base does."""
    state = replace(x, base=None).skeleton_state()
    return {"momentum_regressor": _projected_blocks(state, _body_momentum_regressor(*_twist(state)))}


def energy_regressor(x: Arguments) -> dict[str, Array]:
    """Energy regressor of T = Σ ½ (u, ω)·(momentum about O_j) and U = -Σ g·(m O_j + R m c) (…, 10n each)."""
    n = x.model.n_bodies
    twist = np.concatenate(_twist(x.skeleton_state()), axis=-1)
    state = state_on(ground(x.model, x.base, x["q"].shape[:-1]), x.model.skeleton, x["q"], x["v"], None)
    kinetic = np.einsum("...ia,...iap->...ip", twist, _body_momentum_regressor(twist[..., LINEAR], twist[..., ANGULAR]))
    potential = np.zeros_like(kinetic)
    potential[..., 0] = -state.position @ x.model.gravity
    potential[..., 1:4] = -np.einsum("...iba,b->...ia", state.rotation, x.model.gravity)
    shape = (*x["q"].shape[:-1], BODY_PARAMETERS * n)
    return {"kinetic": kinetic.reshape(shape) / 2, "potential": potential.reshape(shape)}


def _projected_blocks(state: MaximalState, of_bodies: Array) -> Array:
    """(…, n, 10n) of wrenches or momenta per parameter (…, n, 6, 10), at O_j in link axes."""
    model = state.model
    columns = null_space(state).reshape(*state.position.shape[:-1], BODY_DOF, model.nv)
    columns[..., LINEAR, :] = np.einsum("...iba,...ibk->...iak", state.rotation, columns[..., LINEAR, :])
    blocks: Array = np.einsum("...iak,...iap->...kip", columns, of_bodies)
    return blocks.reshape(*blocks.shape[:-2], BODY_PARAMETERS * model.n_bodies)


def _twist(state: MaximalState) -> tuple[Array, Array]:
    """Velocity of O_j and ω (…, n, 3 each) in link axes, of the link frames whose motion the state is."""
    return np.einsum("...iba,...ib->...ia", state.rotation, state.velocity[..., LINEAR]), state.velocity[..., ANGULAR]


def _body_momentum_regressor(u: Array, omega: Array) -> Array:
    """(…, n, 6, 10): m u + ω × m c, and m c × u + I ω about O_j, in link axes."""
    y = np.zeros((*u.shape[:-1], BODY_DOF, BODY_PARAMETERS))
    y[..., LINEAR, 0] = u
    y[..., LINEAR, 1:4] = skew(omega)
    y[..., ANGULAR, 1:4] = -skew(u)
    y[..., ANGULAR, 4:] = _tensor_columns(omega)
    return y


def _body_regressor(state: MaximalState) -> Array:
    """Y of the link frames whose motion the state is (RobotModel.skeleton)."""
    assert state.acceleration is not None
    omega, alpha = state.velocity[..., ANGULAR], state.acceleration[..., ANGULAR]
    compensated = np.einsum(
        "...iba,...ib->...ia", state.rotation, state.acceleration[..., LINEAR] - state.model.gravity
    )
    w, w_dot = skew(omega), skew(alpha)
    y = np.zeros((*compensated.shape[:-1], 6, BODY_PARAMETERS))
    y[..., LINEAR, 0] = compensated
    y[..., LINEAR, 1:4] = w_dot + w @ w
    y[..., ANGULAR, 1:4] = -skew(compensated)
    y[..., ANGULAR, 4:] = _tensor_columns(alpha) + w @ _tensor_columns(omega)
    return y


def _tensor_columns(x: Array) -> Array:
    """L(x) (…, 3, 6) with I x = L(x) (I_xx, I_xy, I_yy, I_xz, I_yz, I_zz)."""
    x1, x2, x3 = x[..., 0], x[..., 1], x[..., 2]
    o = np.zeros_like(x1)
    rows = [[x1, x2, o, x3, o, o], [o, x1, x2, o, x3, o], [o, o, o, x1, x2, x3]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
