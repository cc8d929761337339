"""Torques by Lagrange's equations: with gradients of the energies, and with squares and products of velocities."""

import numpy as np
from textbook_codes.algebra import gradient
from textbook_codes.masses import potential_energy
from textbook_codes.matrices import mass_matrix


def lagrange_torques(arm, q, v, a):
    """d/dt ∂T/∂v - ∂T/∂q + ∂U/∂q."""
    M = mass_matrix(arm, q)
    D = gradient(lambda x: mass_matrix(arm, x), q)
    slope = gradient(lambda x: potential_energy(arm, x), q)
    return M @ a + (D @ v) @ v - 0.5 * np.einsum("jki,j,k->i", D, v, v) + slope


def torques_by_products(arm, q, v, a):
    """Centrifugal torques in v_j², Coriolis torques in v_j v_k of every pair."""
    D = gradient(lambda x: mass_matrix(arm, x), q)
    tau = mass_matrix(arm, q) @ a + gradient(lambda x: potential_energy(arm, x), q)
    for i in range(arm.n):
        for j in range(arm.n):
            tau[i] += (D[i, j, j] - 0.5 * D[j, j, i]) * v[j] ** 2
            for k in range(j + 1, arm.n):
                symbol = 0.5 * (D[i, j, k] + D[i, k, j] - D[j, k, i])
                tau[i] += 2 * symbol * v[j] * v[k]
    return tau
