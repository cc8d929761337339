"""Torques and joint wrenches: Newton-Euler in link axes, and statics by Jacobians."""

import numpy as np
from textbook_codes.algebra import cross, turn
from textbook_codes.kinematics import point_jacobian, poses
from textbook_codes.masses import body_centers


def newton_euler(arm, q, v, a):
    """Forces and moments of the inside body on each body, at its link origin, in link axes."""
    w, dw, acc = [np.zeros(3)], [np.zeros(3)], [-arm.base_rotation.T @ arm.gravity]
    R, r, f, m = [], [], [], []
    for j in range(arm.n):
        i, p = arm.inside[j], arm.axes[j]
        if arm.prismatic[j]:
            R.append(arm.rotations[j])
            r.append(arm.translations[j] + arm.rotations[j] @ p * q[j])
        else:
            R.append(arm.rotations[j] @ turn(p, q[j]))
            r.append(arm.translations[j])
        carried = R[j].T @ w[i]
        acc_j = R[j].T @ (acc[i] + cross(dw[i], r[j]) + cross(w[i], cross(w[i], r[j])))
        if arm.prismatic[j]:
            w.append(carried)
            dw.append(R[j].T @ dw[i])
            acc.append(acc_j + 2 * cross(carried, p * v[j]) + p * a[j])
        else:
            w.append(carried + p * v[j])
            dw.append(R[j].T @ dw[i] + p * a[j] + cross(carried, p * v[j]))
            acc.append(acc_j)
        c, J = arm.centers[j], arm.tensors[j]
        at_center = acc[-1] + cross(dw[-1], c) + cross(w[-1], cross(w[-1], c))
        f.append(arm.masses[j] * at_center)
        m.append(J @ dw[-1] + cross(w[-1], J @ w[-1]) + cross(c, f[j]))
    for j in range(arm.n - 1, -1, -1):
        i = arm.inside[j] - 1
        if i >= 0:
            push = R[j] @ f[j]
            f[i] = f[i] + push
            m[i] = m[i] + R[j] @ m[j] + cross(r[j], push)
    return f, m


def inverse_dynamics(arm, q, v, a):
    f, m = newton_euler(arm, q, v, a)
    return np.array([arm.axes[j] @ (f[j] if arm.prismatic[j] else m[j]) for j in range(arm.n)])


def joint_wrenches(arm, q, v, a):
    f, m = newton_euler(arm, q, v, a)
    return np.array([np.concatenate([f[j], m[j]]) for j in range(arm.n)])


def bias_torque(arm, q, v):
    return inverse_dynamics(arm, q, v, np.zeros(arm.n))


def gravity_torque(arm, q):
    c = body_centers(arm, q)
    tau = np.zeros(arm.n)
    for j in range(arm.n):
        J = point_jacobian(arm, q, j + 1, c[j])
        tau = tau - arm.masses[j] * J[:3].T @ arm.gravity
    return tau


def static_torque(arm, q, external_wrenches):
    """external_wrenches: force, moment on each body at its link origin, in link axes (n, 6)."""
    R, o, _ = poses(arm, q)
    tau = gravity_torque(arm, q)
    for j in range(arm.n):
        J = point_jacobian(arm, q, j + 1, o[j + 1])
        force = R[j + 1] @ external_wrenches[j, :3]
        moment = R[j + 1] @ external_wrenches[j, 3:]
        tau = tau - J[:3].T @ force - J[3:].T @ moment
    return tau


def power(arm, q, v, a):
    return inverse_dynamics(arm, q, v, a) * v
