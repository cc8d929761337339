"""Lagrange's equations by Jacobians and Christoffel symbols, their operations open to slips.

Spong, Hutchinson and Vidyasagar, "Robot Modeling and Control", 2006, section 7.3. Derivatives of the mass matrix are
exact, by complex steps.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

from typing import Any

import numpy as np

from crosscheck.judging.faults.fault import COMPLEX_STEP
from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    joint_placement,
    times,
    turned,
    turned_back,
)
from crosscheck.judging.slips.operations import NOT_TURNED, WRONG_WAY, Operations
from crosscheck.judging.slips.turning import center_in_world, tensor_in_world
from graphdyn.layout import Array


def christoffel(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """M a, C v of the Christoffel symbols, and the weights. Operations see (1 + n) states for each one: its own, then
    a complex step of each joint."""
    q, v, a = state
    n, rows = len(q), q.shape[-1]
    do.see((1 + n) * rows, complex)
    steps = 1j * COMPLEX_STEP * np.concatenate([np.zeros((n, 1)), np.eye(n)], axis=1)
    stepped: Any = (q[:, :, None, :] + steps[:, None, :, None]).reshape(n, 1, (1 + n) * rows)
    mass, weight = _mass_matrix(code, x, stepped, do)
    mass = mass.reshape(*mass.shape[:-1], 1 + n, rows)
    inertia, slopes = mass[..., 0, :].real, mass[..., 1:, :].imag / COMPLEX_STEP  # (i, j, K, k, R)
    tau = np.einsum("ijKR,jKR->iKR", inertia, np.broadcast_to(a, (n, inertia.shape[2], rows)))
    speeds = np.broadcast_to(v, (n, inertia.shape[2], rows))
    along = np.einsum("ijKkR,jKR,kKR->iKR", slopes, speeds, speeds)
    gradient = np.einsum("jkKiR,jKR,kKR->iKR", slopes, speeds, speeds)
    found = []
    for i in range(n):
        first = do.result("½ ∂M_ij/∂q_k in the Christoffel symbols", i, _again(along[i] / 2, n))
        last = do.result("-½ ∂M_jk/∂q_i in the Christoffel symbols", i, _again(-gradient[i] / 2, n))
        second = do.result("½ ∂M_ik/∂q_j in the Christoffel symbols", i, _again(along[i] / 2, n))
        velocity = (first + second + last)[..., :rows].real
        found.append(tau[i] + velocity + weight[i][..., :rows].real)
    return np.stack(np.broadcast_arrays(*found))


AS_HINGE = "taken as that of a hinge, z × (p_c − o) and z"


def _pair(linear: Array, angular: Array) -> Array:
    return np.stack(np.broadcast_arrays(linear, angular))


def _again(x: Array, n: int) -> Array:
    """The states side by side, as often as the operations see them."""
    return np.tile(x, (1,) * (x.ndim - 1) + (1 + n,))


def _mass_matrix(code: DynamicsCode, x: Numbers, q: Array, do: Operations) -> tuple[Array, list[Array]]:
    """M (n, n, K, R) and the torques of the weights, joint by joint (K, R)."""
    n = len(q)
    attitude, origin = [np.eye(3)[:, :, None, None]], [np.zeros((3, 1, 1))]
    axes: list[Array] = []
    path: list[tuple[int, ...]] = []
    mass: list[list[Array]] = [[np.zeros((1, 1))] * n for _ in range(n)]
    weight = [np.zeros((1, 1))] * n
    for b, inside in enumerate(code.inside):
        p = x.axes[b]
        turn, local = joint_placement(code, x, q, b)
        base = attitude[inside]
        R = times(base, turn)
        attitude.append(R)
        origin.append(origin[inside] + do.result("r of the joint in world axes", b, turned(base, local), {
            NOT_TURNED: lambda: local + 0 * base[0], "turned with the outer link": lambda: turned(R, local),
        }))  # fmt: skip
        axes.append(do.result("the joint axis in world axes", b, turned(R, p), {
            NOT_TURNED: lambda: p + 0 * R[0], WRONG_WAY: lambda: turned_back(R, p),
            "turned with the inside link": lambda: turned(base, p),
        }))  # fmt: skip
        path.append((*(path[inside - 1] if inside else ()), b))
        own_c, own_j = x.centers[b], x.tensors[b]
        center = origin[-1] + center_in_world("c in world axes", b, R, base, own_c, do)
        tensor = tensor_in_world(b, R, base, own_j, do)
        linear, angular = {}, {}
        for j in path[b]:
            z, o = axes[j], origin[j + 1]
            if code.prismatic[j]:
                name, slide = (
                    "the column of a sliding joint in the Jacobians of the links",
                    _pair(z + 0 * center, 0 * z),
                )
                pair = do.result(name, j, slide, {
                    AS_HINGE: lambda: _pair(crossed(z, center - o), z),
                })  # fmt: skip
                linear[j], angular[j] = pair[0], pair[1]
            else:
                linear[j] = do.result("z × (p_c - o) in the Jacobians of the links", j, crossed(z, center - o), {
                    "taken with the link origin, not the center of mass": lambda: crossed(z, origin[-1] - o),
                    "taken from the world's origin": lambda: crossed(z, center),
                    "taken from the origin of the inside link": lambda: crossed(z, center - origin[code.inside[j]]),
                })  # fmt: skip
                angular[j] = z
            if j == b:
                column = _pair(linear[j], angular[j])
                own = do.result("the column of its own joint in the Jacobian of each link", b, column)
                linear[j], angular[j] = own[0], own[1]
        for i in path[b]:
            pulled = do.result("the weight m g", b, -x.masses[b] * (x.gravity * linear[i]).sum(axis=0))
            weight[i] = weight[i] + pulled
            for j in path[b]:
                moved = do.result("m J_vᵀ J_v in the mass matrix", b, x.masses[b] * (linear[i] * linear[j]).sum(axis=0))
                spun = do.result(
                    "J_ωᵀ J J_ω in the mass matrix", b, (angular[i] * turned(tensor, angular[j])).sum(axis=0)
                )
                mass[i][j] = mass[i][j] + moved + spun
    whole = np.broadcast_arrays(*(entry for row in mass for entry in row))
    return np.stack(whole).reshape(n, n, *whole[0].shape), weight
