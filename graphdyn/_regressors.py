"""The dynamics as linear functions of the inertial parameters π (ten per body, Body.parameters)."""

import numpy as np
from numpy.typing import ArrayLike

from graphdyn._arrays import joint_arrays, refuse_non_finite
from graphdyn._base_motion import BaseMotion, rooted_ground
from graphdyn._kinematics import MaximalState, null_space, state_on
from graphdyn._methods import Method, is_recursive
from graphdyn._model import RobotModel
from graphdyn._recursive import single_array
from graphdyn._rotation import skew
from graphdyn.kernels.batch import Options
from graphdyn.layout import ANGULAR, BODY_FREEDOMS, BODY_PARAMETERS, LINEAR, Array


def body_regressor(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """Y (…, n, 6, 10): Y_i π_i = inertial minus gravity wrench of body i, at O_i, in link axes [N, N m].

    The Newton-Euler equations (22), (23) moved from the center of mass to the link origin, where they are linear
    in m, m c and I. The identification matrix of Eq. (49) is its counterpart with known centers of mass.
    q, v, a: (…, n); base, method, threads, check, out: see graphdyn._dynamics ("dense" is "projected" here)

    Raises InvalidInput.
    """
    x = joint_arrays(model, base, check=False, q=q, v=v, a=a)
    if is_recursive(method, x, out):
        return single_array(model, "body_regressor", x, base, Options(threads, check), out)
    refuse_non_finite(model, x)
    return _body_regressor(_skeleton_state(model, base, x))


def joint_torque_regressor(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    *,
    base: BaseMotion | None = None,
    method: Method = "auto",
    threads: int | None = None,
    check: bool = True,
    out: Array | None = None,
) -> Array:
    """W (…, n, 10n) with τ = W π, π = model.inertial_parameters [N m or N].

    The body regressors projected onto the joints, as the null space projects the body wrenches.
    q, v, a: (…, n); base, method, threads, check, out: see graphdyn._dynamics ("dense" is "projected" here)

    Raises InvalidInput.
    """
    x = joint_arrays(model, base, check=False, q=q, v=v, a=a)
    if is_recursive(method, x, out):
        return single_array(model, "joint_torque_regressor", x, base, Options(threads, check), out)
    refuse_non_finite(model, x)
    n = model.n_bodies
    state = _skeleton_state(model, base, x)
    columns = null_space(state).reshape(*x["q"].shape[:-1], n, BODY_FREEDOMS, n)
    columns[..., LINEAR, :] = np.einsum("...iba,...ibk->...iak", state.rotation, columns[..., LINEAR, :])
    blocks = np.einsum("...iak,...iap->...kip", columns, _body_regressor(state))
    return blocks.reshape(*x["q"].shape, BODY_PARAMETERS * n)


def _skeleton_state(model: RobotModel, base: BaseMotion | None, x: dict[str, Array]) -> MaximalState:
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
