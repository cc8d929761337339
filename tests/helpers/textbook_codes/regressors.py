"""Matrices that multiply m, m c and I = xx, xy, yy, xz, yz, zz about O (Atkeson, An and Hollerbach, 1986)."""

import numpy as np
from textbook_codes.algebra import hat
from textbook_codes.kinematics import motions, point_jacobian, poses
from textbook_codes.matrices import forward_dynamics, mass_matrix


def tensor_rows(w):
    """L (3, 6) with L I = tensor @ w."""
    x, y, z = w
    return np.array([[x, y, 0, z, 0, 0], [0, x, y, 0, z, 0], [0, 0, 0, x, y, z]])


def body_regressor(arm, q, v, a):
    """Inertial minus gravity wrench of each body at its link origin, in link axes."""
    R, _, _ = poses(arm, q)
    w, dw, _, acc = motions(arm, q, v, a)
    Y = np.zeros((arm.n, 6, 10))
    for j in range(arm.n):
        B = R[j + 1].T
        spin, rate, push = B @ w[j + 1], B @ dw[j + 1], B @ (acc[j + 1] - arm.gravity)
        Y[j, :3, 0] = push
        Y[j, :3, 1:4] = hat(rate) + hat(spin) @ hat(spin)
        Y[j, 3:, 1:4] = -hat(push)
        Y[j, 3:, 4:] = tensor_rows(rate) + hat(spin) @ tensor_rows(spin)
    return Y


def joint_torque_regressor(arm, q, v, a):
    Y = body_regressor(arm, q, v, a)
    return projected(arm, q, Y)


def projected(arm, q, Y):
    """Torques of wrenches on the bodies, column by column."""
    R, o, _ = poses(arm, q)
    W = np.zeros((arm.n, arm.n, 10))
    for i in range(arm.n):
        J = point_jacobian(arm, q, i + 1, o[i + 1])
        B = R[i + 1]
        W[:, i] = J[:3].T @ B @ Y[i, :3] + J[3:].T @ B @ Y[i, 3:]
    return W.reshape(arm.n, 10 * arm.n)


def momentum_regressor(arm, q, v):
    R, _, _ = poses(arm, q)
    w, _, vel, _ = motions(arm, q, v, 0 * v)
    Y = np.zeros((arm.n, 6, 10))
    for j in range(arm.n):
        spin, speed = R[j + 1].T @ w[j + 1], R[j + 1].T @ vel[j + 1]
        Y[j, :3, 0] = speed
        Y[j, :3, 1:4] = hat(spin)
        Y[j, 3:, 1:4] = -hat(speed)
        Y[j, 3:, 4:] = tensor_rows(spin)
    return projected(arm, q, Y)


def kinetic_energy_regressor(arm, q, v):
    R, _, _ = poses(arm, q)
    w, _, vel, _ = motions(arm, q, v, 0 * v)
    Y = np.zeros((arm.n, 10))
    for j in range(arm.n):
        spin, speed = R[j + 1].T @ w[j + 1], R[j + 1].T @ vel[j + 1]
        Y[j, 0] = 0.5 * speed @ speed
        Y[j, 1:4] = np.cross(speed, spin)
        Y[j, 4:] = 0.5 * spin @ tensor_rows(spin)
    return Y.ravel()


def potential_energy_regressor(arm, q):
    R, o, _ = poses(arm, q)
    Y = np.zeros((arm.n, 10))
    for j in range(arm.n):
        Y[j, 0] = -arm.gravity @ o[j + 1]
        Y[j, 1:4] = -R[j + 1].T @ arm.gravity
    return Y.ravel()


def base_columns(arm, limit=1e-9):
    """Columns of the torque regressor that are no combinations of those before them, at random states."""
    rng = np.random.default_rng(0)
    W = np.concatenate([joint_torque_regressor(arm, *rng.normal(size=(3, arm.n))) for _ in range(10 * arm.n)])
    chosen = []
    rest = W / (np.linalg.norm(W, axis=0) + (np.linalg.norm(W, axis=0) == 0))
    for k in range(W.shape[1]):
        size = np.linalg.norm(rest[:, k])
        if size > limit:
            chosen.append(k)
            e = rest[:, k] / size
            rest = rest - np.outer(e, e @ rest)
    return chosen


def base_regressor(arm, q, v, a):
    return joint_torque_regressor(arm, q, v, a)[:, base_columns_of(arm)]


def base_columns_of(arm):
    if not hasattr(arm, "kept"):
        object.__setattr__(arm, "kept", base_columns(arm))
    return arm.kept


def forward_dynamics_parameter_derivatives(arm, q, v, tau):
    a = forward_dynamics(arm, q, v, tau)
    return -np.linalg.solve(mass_matrix(arm, q), joint_torque_regressor(arm, q, v, a))
