"""Excitation of each group of parameters by a recording."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import BODY_PARAMETERS
from graphdyn.model.inertia import PARAMETER_NAMES

FIRST_MOMENTS = sum(not name.startswith("I") for name in PARAMETER_NAMES)
"""Number of a body's parameters before the tensor: mass and m c come first among the ten."""


@dataclass(frozen=True)
class Excitation:
    """Excitation of one group of base parameters.

    name: of the group
    determined: number that the recording determines; structural: number that some motion could determine
    weakest: smallest singular value of the group's part of the regressor that no other group can imitate, joints
        weighted by their torque and columns at unit length: 1 is best, 0 is not excited; NaN for an empty group
    """

    name: str
    determined: int
    structural: int
    weakest: float


def excitation(problem: Problem) -> tuple[Excitation, ...]:
    """Excitation of masses and centers of mass, of inertia tensors, and of every further term of the torque model."""
    equations, base, structural = problem.equations, problem.base, problem.structure.base
    size = np.sqrt(equations.measured_squares / np.maximum(equations.counts, 1))
    r, _ = equations.weighted(np.where(size > 0, size, 1.0))
    length = np.linalg.norm(r, axis=0)
    unit = r / np.where(length > 0, length, 1.0)
    found = []
    for name, columns in groups(problem.torque_model):
        own = np.isin(base.independent, columns)
        weakest = float("nan")
        if own.any():
            q = np.linalg.qr(unit[:, ~own])[0]
            left = unit[:, own] - q @ (q.T @ unit[:, own])
            weakest = float(np.linalg.svd(left, compute_uv=False)[-1])
        found.append(Excitation(name, int(own.sum()), int(np.isin(structural.independent, columns).sum()), weakest))
    return tuple(found)


def groups(torque_model: TorqueModel) -> Iterator[tuple[str, list[int]]]:
    """Names of groups, and their columns of the torque model."""
    start = 0
    for term in torque_model.terms:
        own = term.columns(torque_model.model)
        columns = range(start, start + len(own))
        if isinstance(term, RigidBodies):
            yield "masses and centers of mass", [k for k in columns if (k - start) % BODY_PARAMETERS < FIRST_MOMENTS]
            yield "inertia tensors", [k for k in columns if (k - start) % BODY_PARAMETERS >= FIRST_MOMENTS]
        elif own:
            yield _words(type(term).__name__), list(columns)
        start += len(own)


def _words(name: str) -> str:
    """A class name as words: "RotorInertia" → "rotor inertia"."""
    return "".join(f" {letter.lower()}" if letter.isupper() else letter for letter in name).strip()
