"""The mass matrix by composite rigid bodies as people write it, its operations open to slips.

Walker and Orin, "Efficient dynamic computer simulation of robotic mechanisms", 1982; Featherstone, "Rigid Body Dynamics
Algorithms", 2008, table 6.2.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    joint_placement,
    times,
    torque_recursion,
    turned,
    turned_back,
)
from crosscheck.judging.slips.operations import NOT_TURNED, WRONG_WAY, Operations
from graphdyn.layout import Array

Inertia = tuple[Array, Array, Array]
"""Mass, first moment (3, …) and tensor (3, 3, …) about the link origin, of a link and all bodies outside it."""


def composite_bodies(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """M a of the composite bodies, and right torques at a = 0."""
    q, v, a = state
    n = len(code.inside)
    frames: list[tuple[Array, Array]] = []
    inertias: list[Inertia] = []
    for j in range(n):
        m, c = x.masses[j], x.centers[j]
        frames.append(joint_placement(code, x, q, j))
        inertias.append((m, m * c, x.tensors[j] + m * _about(c, c)))
    tau = list(torque_recursion(code, x, (q, v, 0 * a)))
    bodies = list(inertias)
    for j in reversed(range(n)):
        i, p, slides = code.inside[j] - 1, x.axes[j], code.prismatic[j]
        whole = inertias[j]
        if i >= 0:
            passed = do.result("the composite inertia that is passed on", j, _stacked(whole), {
                "that of its first link alone": lambda: _stacked(bodies[j]),
            })  # fmt: skip
            added = _moved(j, (passed[0], passed[1:4], passed[4:].reshape(3, 3, *passed.shape[1:])), *frames[j], do)
            inertias[i] = tuple(own + more for own, more in zip(inertias[i], added, strict=True))  # type: ignore[assignment]
        moment = do.result(
            "the moment of the composite inertia", j, crossed(whole[1], p) if slides else turned(whole[2], p)
        )
        force = do.result("the force of the composite inertia", j, whole[0] * p if slides else crossed(p, whole[1]))
        k = j
        while True:
            along = (x.axes[k] * (force if code.prismatic[k] else moment)).sum(axis=0)
            entry = do.result("the diagonal of the mass matrix" if k == j else "M_jk off the diagonal", j, along)
            if k not in (j, code.inside[j] - 1):
                entry = do.result("M_jk of joints with others between them", j, entry)
            tau[k] = tau[k] + entry * a[j]
            if k != j:
                tau[j] = tau[j] + entry * a[k]
            if (inside := code.inside[k] - 1) < 0:
                break
            (turn, r), f = frames[k], force
            force = do.inward("the force, passed on to the inside links,", k, turn, f)
            lever = do.result("r × f, passed on to the inside links,", k, crossed(r, force))
            moment = do.inward("the moment, passed on to the inside links,", k, turn, moment) + lever
            k = inside
    return np.stack(np.broadcast_arrays(*tau))


def _stacked(inertia: Inertia) -> Array:
    """The inertia as one array (13, …)."""
    mass, first, tensor = inertia
    parts = [part.reshape(-1, *part.shape[-2:]) for part in (mass[None], first, tensor)]
    shape = np.broadcast_shapes(*(part.shape[1:] for part in parts))
    return np.concatenate([np.broadcast_to(part, (len(part), *shape)) for part in parts])


def _about(x: Array, y: Array) -> Array:
    """-x× y× (3, 3, …)."""
    product = (x * y).sum(axis=0)
    found: Array = np.eye(3).reshape(3, 3, *[1] * product.ndim) * product - y[:, None] * x[None]
    return found


def _moved(j: int, inertia: Inertia, turn: Array, r: Array, do: Operations) -> Inertia:
    """A composite inertia in axes of the inside link, about its origin."""
    mass, first, tensor = inertia
    m = do.result("the mass of the composite body, passed on,", j, mass + 0 * r[0])
    h = do.result("m c of the composite body, in axes of the inside link,", j, turned(turn, first), {
        NOT_TURNED: lambda: first + 0 * turn[0], WRONG_WAY: lambda: turned_back(turn, first),
    })  # fmt: skip
    back = np.swapaxes(turn, 0, 1)
    turned_tensor = times(times(turn, tensor), back)
    own = do.result("the tensor of the composite body, in axes of the inside link,", j, turned_tensor, {
        NOT_TURNED: lambda: tensor + 0 * turn, WRONG_WAY: lambda: times(times(back, tensor), turn),
        "taken as R J, the second R missing": lambda: times(turn, tensor),
    })  # fmt: skip
    far = do.result("the term -m r× r× in the tensor of the composite body", j, m * _about(r, r))
    mixed = do.result("the terms of r and m c in the tensor of the composite body", j, _about(r, h) + _about(h, r))
    whole = own + mixed + far
    shifted = do.result("the tensor of the composite body, shifted to the inside link's origin,", j, whole, {
        "taken as if it were about the center of mass": lambda: whole + _about(h, h) / m,
    })  # fmt: skip
    moved = do.result("m r in the first moment of the composite body", j, m * r)
    return m, h + moved, shifted
