"""Torques and mass matrix by spatial vectors, angular parts first (Featherstone, 2008, tables 5.1 and 6.2)."""

import numpy as np
from textbook_codes.algebra import hat, turn
from textbook_codes.articulated import across


def joint_transforms(arm, q):
    """Motion transforms from the inside links, and joint axes as motions."""
    X, S = [], []
    for j in range(arm.n):
        p, R, r = arm.axes[j], arm.rotations[j], arm.translations[j]
        if arm.prismatic[j]:
            r = r + R @ p * q[j]
            S.append(np.concatenate([np.zeros(3), p]))
        else:
            R = R @ turn(p, q[j])
            S.append(np.concatenate([p, np.zeros(3)]))
        X.append(np.block([[R.T, np.zeros((3, 3))], [-R.T @ hat(r), R.T]]))
    return X, S


def rigid_inertia(arm, j):
    """About the link origin, in link axes."""
    m, c = arm.masses[j], hat(arm.centers[j])
    return np.block([[arm.tensors[j] - m * c @ c, m * c], [-m * c, m * np.eye(3)]])


def spatial_torques(arm, q, v, a):
    X, S = joint_transforms(arm, q)
    V, A = [np.zeros(6)], [np.concatenate([np.zeros(3), -arm.base_rotation.T @ arm.gravity])]
    f = []
    for j in range(arm.n):
        i = arm.inside[j]
        V.append(X[j] @ V[i] + S[j] * v[j])
        A.append(X[j] @ A[i] + S[j] * a[j] + across(V[j + 1]) @ S[j] * v[j])
        inertia = rigid_inertia(arm, j)
        f.append(inertia @ A[j + 1] - across(V[j + 1]).T @ inertia @ V[j + 1])
    tau = np.zeros(arm.n)
    for j in range(arm.n - 1, -1, -1):
        tau[j] = S[j] @ f[j]
        i = arm.inside[j] - 1
        if i >= 0:
            f[i] = f[i] + X[j].T @ f[j]
    return tau


def composite_mass_matrix(arm, q):
    X, S = joint_transforms(arm, q)
    composite = [rigid_inertia(arm, j) for j in range(arm.n)]
    for j in range(arm.n - 1, -1, -1):
        i = arm.inside[j] - 1
        if i >= 0:
            composite[i] = composite[i] + X[j].T @ composite[j] @ X[j]
    M = np.zeros((arm.n, arm.n))
    for j in range(arm.n):
        force = composite[j] @ S[j]
        M[j, j] = S[j] @ force
        k = j
        while arm.inside[k] > 0:
            force = X[k].T @ force
            k = arm.inside[k] - 1
            M[j, k] = M[k, j] = S[k] @ force
    return M


def composite_accelerations(arm, q, v, tau):
    return np.linalg.solve(composite_mass_matrix(arm, q), tau - spatial_torques(arm, q, v, 0 * v))
