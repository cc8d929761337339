"""Mass matrix by Jacobians, Coriolis matrix by Christoffel symbols, and accelerations from both."""

# ruff: noqa: E741 - I is an inertia tensor, as in textbooks

import numpy as np
from textbook_codes.algebra import gradient
from textbook_codes.kinematics import point_jacobian, poses
from textbook_codes.masses import body_centers
from textbook_codes.torques import bias_torque


def mass_matrix(arm, q):
    R, _, _ = poses(arm, q)
    c = body_centers(arm, q)
    M = np.zeros((arm.n, arm.n))
    for j in range(arm.n):
        J = point_jacobian(arm, q, j + 1, c[j])
        I = R[j + 1] @ arm.tensors[j] @ R[j + 1].T
        M = M + arm.masses[j] * J[:3].T @ J[:3] + J[3:].T @ I @ J[3:]
    return M


def mass_matrix_inverse(arm, q):
    return np.linalg.inv(mass_matrix(arm, q))


def coriolis_matrix(arm, q, v):
    D = gradient(lambda x: mass_matrix(arm, x), q)
    C = np.zeros((arm.n, arm.n))
    for i in range(arm.n):
        for j in range(arm.n):
            for k in range(arm.n):
                C[i, j] += 0.5 * (D[i, j, k] + D[i, k, j] - D[j, k, i]) * v[k]
    return C


def forward_dynamics(arm, q, v, tau):
    return np.linalg.solve(mass_matrix(arm, q), tau - bias_torque(arm, q, v))
