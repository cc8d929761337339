"""Forward dynamics by articulated bodies (Featherstone, 2008, table 7.1), angular parts first."""

import numpy as np
from textbook_codes.algebra import hat, turn


def across(m):
    """The matrix of the product with motions."""
    return np.block([[hat(m[:3]), np.zeros((3, 3))], [hat(m[3:]), hat(m[:3])]])


def articulated_accelerations(arm, q, v, tau):
    n = arm.n
    X, S, V, c, IA, pA = [], [], [np.zeros(6)], [], [], []
    for j in range(n):
        p = arm.axes[j]
        if arm.prismatic[j]:
            R, r = arm.rotations[j], arm.translations[j] + arm.rotations[j] @ p * q[j]
            S.append(np.concatenate([np.zeros(3), p]))
        else:
            R, r = arm.rotations[j] @ turn(p, q[j]), arm.translations[j]
            S.append(np.concatenate([p, np.zeros(3)]))
        X.append(np.block([[R.T, np.zeros((3, 3))], [-R.T @ hat(r), R.T]]))
        V.append(X[j] @ V[arm.inside[j]] + S[j] * v[j])
        c.append(across(V[j + 1]) @ S[j] * v[j])
        m, h = arm.masses[j], arm.masses[j] * arm.centers[j]
        about = arm.tensors[j] - hat(h) @ hat(arm.centers[j])
        IA.append(np.block([[about, hat(h)], [-hat(h), m * np.eye(3)]]))
        pA.append(-across(V[j + 1]).T @ IA[j] @ V[j + 1])
    U, d, u = [None] * n, [None] * n, [None] * n
    for j in range(n - 1, -1, -1):
        U[j] = IA[j] @ S[j]
        d[j] = S[j] @ U[j]
        u[j] = tau[j] - S[j] @ pA[j]
        i = arm.inside[j] - 1
        if i >= 0:
            Ia = IA[j] - np.outer(U[j], U[j]) / d[j]
            pa = pA[j] + Ia @ c[j] + U[j] * u[j] / d[j]
            IA[i] = IA[i] + X[j].T @ Ia @ X[j]
            pA[i] = pA[i] + X[j].T @ pa
    acc = [np.concatenate([np.zeros(3), -arm.base_rotation.T @ arm.gravity])]
    found = np.zeros(n)
    for j in range(n):
        before = X[j] @ acc[arm.inside[j]] + c[j]
        found[j] = (u[j] - U[j] @ before) / d[j]
        acc.append(before + S[j] * found[j])
    return found
