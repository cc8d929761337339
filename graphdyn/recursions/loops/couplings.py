"""Robots with couplings: the recursions of all joints, projected onto those that no others drive.

With all joint positions K q + o, torques become Kᵀ τ and Jacobians J K, for any answer that has an entry per joint.
What asks for accelerations solves Kᵀ M K instead of eliminating body after body: a coupling ties joints that are not
neighbors.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from graphdyn.model.coupling import DegreesOfFreedom
from graphdyn.recursions.declarations import with_couplings
from graphdyn.recursions.forward import Drives
from graphdyn.recursions.inertia import inverted, inverted_mass_matrix, mass_matrix
from graphdyn.recursions.inverse import Loads, inverse_dynamics
from graphdyn.recursions.mechanism.mechanism import Links
from graphdyn.recursions.motion import Root
from graphdyn.scalars.vectors import PerJoint, Scalars, scalars


def projected(answer: Scalars, shape: Sequence[int | str], degrees_of_freedom: DegreesOfFreedom | None) -> Scalars:
    """An answer for all joints, with each axis "n" of its shape turned to the free ones; as it is without degrees of
    freedom."""
    for axis, size in enumerate(shape):
        if size == "n" and degrees_of_freedom is not None:
            answer = np.moveaxis(np.moveaxis(answer, axis, -1) @ scalars(degrees_of_freedom.matrix), -1, axis)
    return answer


@with_couplings
def forward_dynamics(
    links: Links,
    root: Root,
    degrees_of_freedom: DegreesOfFreedom,
    q: PerJoint,
    v: PerJoint,
    tau: PerJoint,
    external: Loads = None,
) -> dict[str, Any]:
    """Answers like those of graphdyn.recursions.forward, of q and v of all joints and the torques of the free ones."""
    _, a, pivots = solved(links, root, degrees_of_freedom, q, v, tau, external)
    found = inverse_dynamics(links, root, q, v, everywhere(a, degrees_of_freedom), external)
    return {**found, "a": a, "pivots": pivots}


def driven(
    links: Links,
    root: Root,
    degrees_of_freedom: DegreesOfFreedom,
    q: PerJoint,
    v: PerJoint,
    tau: PerJoint,
    external: Loads,
    drives: Drives,
) -> dict[str, list[Any]]:
    """a and required (n) of the free joints, with rotors, and with joints that friction holds (Drives).

    A joint that is held has a row and a column of the unit matrix, and a = 0.
    """
    mass = projected(mass_matrix(links, q), ("n", "n"), degrees_of_freedom)
    mass[np.diag_indices(len(mass))] += np.array(drives.rotor, dtype=object)
    bias = projected(torques(links, root, q, v, [0.0] * len(links), external), ("n",), degrees_of_freedom)
    free = np.array(drives.free, dtype=object)
    moving = mass * np.outer(free, free)
    moving[np.diag_indices(len(mass))] += 1.0 - free
    inverse, _ = inverted(moving, [range(j)[::-1] for j in range(len(mass))])
    a = inverse @ (free * (np.array(tau, dtype=object) - bias))
    return {"a": list(a), "required": list(mass @ a + bias)}


@with_couplings
def mass_matrix_inverse(links: Links, degrees_of_freedom: DegreesOfFreedom, q: PerJoint) -> dict[str, Any]:
    """mass_matrix_inverse (n n) and pivots."""
    inverse, pivots = _inverted_mass_matrix(links, degrees_of_freedom, q)
    return {"mass_matrix_inverse": inverse, "pivots": pivots}


@with_couplings
def power(
    links: Links,
    root: Root,
    degrees_of_freedom: DegreesOfFreedom,
    q: PerJoint,
    v: PerJoint,
    a: PerJoint,
    external: Loads = None,
) -> dict[str, Any]:
    """τ_j v_j (n) of the free joints, whose torques move the driven ones too."""
    tau = torques(links, root, q, v, a, external)
    rates = np.array(v, dtype=object)[list(degrees_of_freedom.independent)]
    return {"power": projected(tau, ("n",), degrees_of_freedom) * rates}


def solved(
    links: Links,
    root: Root,
    degrees_of_freedom: DegreesOfFreedom | None,
    q: PerJoint,
    v: PerJoint,
    tau: PerJoint,
    external: Loads,
) -> tuple[Scalars, Scalars, list[Any]]:
    """M⁻¹ (n, n), a = M⁻¹ (τ - h) (n,), and the pivots (n); of all joints without degrees of freedom, else of the free
    ones."""
    inverse, pivots = (
        inverted_mass_matrix(links, q)
        if degrees_of_freedom is None
        else _inverted_mass_matrix(links, degrees_of_freedom, q)
    )
    bias = torques(links, root, q, v, [0.0] * len(links), external)
    return inverse, inverse @ (np.array(tau, dtype=object) - projected(bias, ("n",), degrees_of_freedom)), pivots


def everywhere(a: Scalars, degrees_of_freedom: DegreesOfFreedom | None) -> list[Any]:
    """The accelerations of all joints (n,)."""
    return list(a if degrees_of_freedom is None else scalars(degrees_of_freedom.matrix) @ a)


def torques(links: Links, root: Root, q: PerJoint, v: PerJoint, a: PerJoint, external: Loads) -> Scalars:
    """That all joints need (n,)."""
    return np.array(inverse_dynamics(links, root, q, v, a, external)["tau"], dtype=object)


def _inverted_mass_matrix(links: Links, degrees_of_freedom: DegreesOfFreedom, q: PerJoint) -> tuple[Scalars, list[Any]]:
    """(Kᵀ M K)⁻¹ (n, n), and its pivots (n)."""
    mass = projected(mass_matrix(links, q), ("n", "n"), degrees_of_freedom)
    return inverted(mass, [range(j)[::-1] for j in range(len(mass))])
