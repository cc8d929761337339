"""Torques by Newton-Euler in world axes, moments about the world's origin."""

# ruff: noqa: E741 - I is an inertia tensor, as in textbooks

import numpy as np
from textbook_codes.algebra import cross
from textbook_codes.kinematics import motions, poses


def torques_in_world_axes(arm, q, v, a):
    R, o, z = poses(arm, q)
    w, dw, _, acc = motions(arm, q, v, a)
    force, moment = [], []
    for j in range(arm.n):
        b = j + 1
        c = R[b] @ arm.centers[j]
        I = R[b] @ arm.tensors[j] @ R[b].T
        at_center = acc[b] + cross(dw[b], c) + cross(w[b], cross(w[b], c)) - arm.gravity
        force.append(arm.masses[j] * at_center)
        moment.append(I @ dw[b] + cross(w[b], I @ w[b]) + cross(o[b] + c, force[j]))
    tau = np.zeros(arm.n)
    for j in range(arm.n - 1, -1, -1):
        tau[j] = z[j] @ (force[j] if arm.prismatic[j] else moment[j] - cross(o[j + 1], force[j]))
        i = arm.inside[j] - 1
        if i >= 0:
            force[i] = force[i] + force[j]
            moment[i] = moment[i] + moment[j]
    return tau
