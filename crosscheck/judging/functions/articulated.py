"""Forward dynamics by articulated bodies as people write it, many codes at once, its operations open to slips.

Featherstone, "Rigid Body Dynamics Algorithms", 2008, table 7.1, with [angular; linear] vectors in link axes.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    joint_placement,
)
from crosscheck.judging.slips.operations import ONCE, Operations
from graphdyn.layout import Array


def articulated_bodies(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """Accelerations at torques, the third of the arguments (n, K, R)."""
    q, v, tau = state
    zero = np.zeros((6, 1, 1))
    pulled = do.result("gravity, as an acceleration of the base,", ONCE, -x.gravity)
    velocities, accelerations = [zero], [np.concatenate([0 * pulled, pulled])]
    transforms: list[Array] = []
    axes: list[Array] = []
    carried: list[Array] = []
    inertias: list[Array] = []
    biases: list[Array] = []
    for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
        p = x.axes[j]
        turn, r = joint_placement(code, x, q, j)
        X, S = _transform(turn, r), np.concatenate([0 * p, p] if slides else [p, 0 * p])
        velocity = do.result("the velocity of the inside link", j, _of(X, velocities[inside])) + S * v[j]
        inertia = _inertia(x.masses[j], x.centers[j], x.tensors[j])
        momentum = _of(inertia, velocity)
        transforms.append(X)
        axes.append(S)
        velocities.append(velocity)
        carried.append(_crossed(velocity, S * v[j]))
        inertias.append(inertia)
        biases.append(do.result("the bias force v ×* I v", j, _bias(velocity, inertia), {
            "taken with ×, that of motions": lambda: _crossed(velocity, momentum),
            "taken without S q̇ of the joint in v": lambda: _bias(velocity - S * v[j], inertia),
        }))  # fmt: skip
    links = list(inertias)
    given: list[tuple[Array, Array, Array]] = []
    for j in reversed(range(len(code.inside))):
        S, inertia, bias, c = axes[j], inertias[j], biases[j], carried[j]
        U = do.result("U = Iᴬ S", j, _of(inertia, S), {
            "taken with the inertia of the link alone": lambda: _of(links[j], S),
        })  # fmt: skip
        d = (S * U).sum(axis=0)
        u = tau[j] - do.result("Sᵀ p in u", j, (S * bias).sum(axis=0))
        given.append((U, d, u))
        i = code.inside[j] - 1
        if i < 0:
            continue
        lost = do.result("U Uᵀ / d, by which the articulated inertia is less,", j, U[:, None] * U[None] / d)
        left = inertia - lost
        known = do.result("Iₐ c in the force passed on, c = v × S q̇,", j, _of(left, c), {
            "taken with the inertia that is not reduced": lambda: _of(inertia, c),
        })  # fmt: skip
        pushed = do.result("U u / d in the force passed on", j, U * u / d)
        X = transforms[j]
        moved = _times(_times(np.swapaxes(X, 0, 1), left), X)
        inertias[i] = inertias[i] + do.result("Xᵀ Iₐ X, the inertia passed on,", j, moved, {
            "taken as X Iₐ Xᵀ": lambda: _times(_times(X, left), np.swapaxes(X, 0, 1)),
            "not transformed": lambda: left + 0 * moved,
        })  # fmt: skip
        whole = bias + known + pushed
        biases[i] = biases[i] + do.result("Xᵀ p, the force passed on,", j, _of_transposed(X, whole), {
            "taken as X p, not transposed": lambda: _of(X, whole), "not transformed": lambda: whole + 0 * X[0],
        })  # fmt: skip
    found = []
    for j, (inside, (U, d, u)) in enumerate(zip(code.inside, reversed(given), strict=True)):
        along = do.result("c = v × S q̇ in the accelerations, on the way out,", j, carried[j])
        moved = do.result("the acceleration of the inside link", j, _of(transforms[j], accelerations[inside])) + along
        rate = (u - do.result("Uᵀ a in q̈", j, (U * moved).sum(axis=0), {
            "taken without c = v × S q̇, which is added later": lambda: (U * (moved - along)).sum(axis=0),
            "taken with the acceleration of the inside link, not transformed": lambda: (
                (U * accelerations[inside]).sum(axis=0)
            ),
        })) / d  # fmt: skip
        accelerations.append(moved + do.result("S q̈ in the acceleration of the link", j, axes[j] * rate))
        found.append(rate)
    return np.stack(np.broadcast_arrays(*found))


def _transform(turn: Array, r: Array) -> Array:
    """The transform of motions from the inside link to the link (6, 6, …)."""
    back = np.swapaxes(turn, 0, 1)
    lower = -_times(back, _skew(r))
    back = back + 0 * lower
    return np.concatenate([np.concatenate([back, 0 * back], axis=1), np.concatenate([lower, back], axis=1)])


def _inertia(mass: Array, c: Array, tensor: Array) -> Array:
    """About the link origin (6, 6, …)."""
    first = _skew(mass * c)
    whole = tensor - _times(first, _skew(c))
    own = mass * np.eye(3)[:, :, None, None] + 0 * first
    whole = whole + 0 * first
    return np.concatenate([np.concatenate([whole, first], axis=1), np.concatenate([-first, own], axis=1)])


def _skew(x: Array) -> Array:
    zero = 0 * x[0]
    return np.array([[zero, -x[2], x[1]], [x[2], zero, -x[0]], [-x[1], x[0], zero]])


def _cross_matrix(motion: Array) -> Array:
    """v × of motions (6, 6, …)."""
    w, u = _skew(motion[:3]), _skew(motion[3:])
    return np.concatenate([np.concatenate([w, 0 * w], axis=1), np.concatenate([u, w], axis=1)])


def _crossed(motion: Array, other: Array) -> Array:
    return _of(_cross_matrix(motion), other)


def _bias(motion: Array, inertia: Array) -> Array:
    """v ×* I v."""
    return -_of_transposed(_cross_matrix(motion), _of(inertia, motion))


def _of(matrix: Array, vector: Array) -> Array:
    product: Array = (matrix * vector[None]).sum(axis=1)
    return product


def _of_transposed(matrix: Array, vector: Array) -> Array:
    return _of(np.swapaxes(matrix, 0, 1), vector)


def _times(first: Array, second: Array) -> Array:
    product: Array = (first[:, :, None] * second[None]).sum(axis=1)
    return product
