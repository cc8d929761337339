"""Center of mass, momentum and energies, from sums over the bodies in world axes."""

# ruff: noqa: E741 - I is an inertia tensor, as in textbooks

import numpy as np
from textbook_codes.algebra import cross
from textbook_codes.kinematics import motions, point_jacobian, poses


def body_centers(arm, q):
    """Centers of mass of the bodies, in the world."""
    R, o, _ = poses(arm, q)
    return [o[j + 1] + R[j + 1] @ arm.centers[j] for j in range(arm.n)]


def center_of_mass(arm, q):
    c = body_centers(arm, q)
    total = sum(arm.masses[j] for j in range(arm.n))
    return sum(arm.masses[j] * c[j] for j in range(arm.n)) / total


def center_of_mass_jacobian(arm, q):
    c = body_centers(arm, q)
    J = np.zeros((3, arm.n))
    for j in range(arm.n):
        J += arm.masses[j] * point_jacobian(arm, q, j + 1, c[j])[:3]
    return J / np.sum(arm.masses)


def center_velocities(arm, q, v):
    R, _, _ = poses(arm, q)
    w, _, vel, _ = motions(arm, q, v, 0 * v)
    return [vel[j + 1] + cross(w[j + 1], R[j + 1] @ arm.centers[j]) for j in range(arm.n)]


def center_of_mass_velocity(arm, q, v):
    rates = center_velocities(arm, q, v)
    return sum(arm.masses[j] * rates[j] for j in range(arm.n)) / np.sum(arm.masses)


def momentum(arm, q, v):
    """Linear, then angular about the center of mass."""
    R, _, _ = poses(arm, q)
    w, _, _, _ = motions(arm, q, v, 0 * v)
    c, rates, com = body_centers(arm, q), center_velocities(arm, q, v), center_of_mass(arm, q)
    linear, angular = np.zeros(3), np.zeros(3)
    for j in range(arm.n):
        p = arm.masses[j] * rates[j]
        I = R[j + 1] @ arm.tensors[j] @ R[j + 1].T
        linear = linear + p
        angular = angular + I @ w[j + 1] + cross(c[j] - com, p)
    return np.concatenate([linear, angular])


def centroidal_map(arm, q):
    R, _, _ = poses(arm, q)
    c, com = body_centers(arm, q), center_of_mass(arm, q)
    A = np.zeros((6, arm.n))
    for j in range(arm.n):
        J = point_jacobian(arm, q, j + 1, c[j])
        I = R[j + 1] @ arm.tensors[j] @ R[j + 1].T
        for k in range(arm.n):
            p = arm.masses[j] * J[:3, k]
            A[:3, k] += p
            A[3:, k] += I @ J[3:, k] + cross(c[j] - com, p)
    return A


def kinetic_energy(arm, q, v):
    R, _, _ = poses(arm, q)
    w, _, _, _ = motions(arm, q, v, 0 * v)
    rates = center_velocities(arm, q, v)
    energy = 0.0
    for j in range(arm.n):
        spin = R[j + 1].T @ w[j + 1]
        energy += 0.5 * arm.masses[j] * rates[j] @ rates[j]
        energy += 0.5 * spin @ arm.tensors[j] @ spin
    return energy


def potential_energy(arm, q):
    c = body_centers(arm, q)
    energy = 0.0
    for j in range(arm.n):
        energy -= arm.masses[j] * arm.gravity @ c[j]
    return energy
