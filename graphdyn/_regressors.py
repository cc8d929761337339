"""Regressors as the equations read: the Newton-Euler equations as linear functions of the inertial parameters."""

from __future__ import annotations

import numpy as np

from graphdyn._base_motion import BaseMotion, rooted_ground
from graphdyn._kinematics import MaximalState, null_space, state_on
from graphdyn._model import RobotModel
from graphdyn._projected import Arguments
from graphdyn._rotation import skew
from graphdyn.layout import ANGULAR, BODY_FREEDOMS, BODY_PARAMETERS, LINEAR, Array


def body_regressor(model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False) -> dict[str, Array]:
    """Y (…, n, 6, 10) at x["q"], x["v"], x["a"]; there are no multipliers that a dense form would solve for."""
    return {"body_regressor": _body_regressor(_skeleton_state(model, base, x))}


def joint_torque_regressor(
    model: RobotModel, x: Arguments, base: BaseMotion | None, dense: bool = False
) -> dict[str, Array]:
    """W (…, n, 10n): the body regressors projected onto the joints, as the null space projects the body wrenches."""
    n = model.n_bodies
    state = _skeleton_state(model, base, x)
    columns = null_space(state).reshape(*x["q"].shape[:-1], n, BODY_FREEDOMS, n)
    columns[..., LINEAR, :] = np.einsum("...iba,...ibk->...iak", state.rotation, columns[..., LINEAR, :])
    blocks = np.einsum("...iak,...iap->...kip", columns, _body_regressor(state))
    return {"joint_torque_regressor": blocks.reshape(*x["q"].shape, BODY_PARAMETERS * n)}


def _skeleton_state(model: RobotModel, base: BaseMotion | None, x: Arguments) -> MaximalState:
    """The motion of the link frames."""
    return state_on(rooted_ground(model, base, x["q"].shape[:-1]), model.skeleton, x["q"], x["v"], x["a"])


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
