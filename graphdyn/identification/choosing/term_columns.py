"""Columns of many terms over the same rows of a recording, filtered and thinned, to be combined into torque models."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.algebra.base_parameters import BaseParameters
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import Term
from graphdyn.layout import Array


def every_row(rows: int, most: int) -> int:
    """The smallest k for which every k-th of the rows is at most this many."""
    return max(1, -(-rows // most))


@dataclass(frozen=True, eq=False)
class TermColumns:
    """The equations of N rows: those of the fixed terms, and the columns of terms that may be added.

    torque_model: the fixed terms, p parameters
    base: base parameters of the fixed terms over random states
    matrix: columns of these base parameters                (N, n, b)
    additions: columns of each term that may be added       (N, n, k)
    right: measured minus known torque                      (N, n)  [N m or N]
    measured: measured torque                               (N, n)  [N m or N]
    velocity: joint velocities                              (N, n)  [rad/s or m/s]
    kept: which equations count in a fit                    (N, n)
    every: number of rows of the recording for each of these
    """

    torque_model: TorqueModel
    base: BaseParameters
    matrix: Array
    additions: Mapping[str, Array]
    right: Array
    measured: Array
    velocity: Array
    kept: NDArray[np.bool_]
    every: int

    @classmethod
    def of(cls, problem: Problem, additions: Mapping[str, Term], every: int) -> TermColumns:
        """Every k-th row of a problem with the fixed terms alone. Raises InvalidInput as the terms do."""
        names = ("matrix", "right", "measured", "velocity", "kept")
        matrix, right, measured, velocity, kept = _thinned(problem, names, every)
        found = {name: _columns(problem, term, every, len(right)) for name, term in additions.items()}
        base = problem.structure.base
        return cls(problem.torque_model, base, matrix, found, right, measured, velocity, kept.astype(bool), every)

    def __len__(self) -> int:
        return len(self.right)

    @property
    def n_joints(self) -> int:
        """Number of joints n."""
        return int(self.right.shape[1])


def _columns(problem: Problem, term: Term, every: int, size: int) -> Array:
    """Filtered columns of one term alone, zero for those that no motion determines (N, n, k)."""
    torque_model = TorqueModel(problem.torque_model.model, (term,))
    own = replace(problem, torque_model=torque_model, progress=None)
    if not own.structure.base.rank:  # such as friction that grows with the load, where gravity loads no joint
        return np.zeros((size, problem.n_joints, len(torque_model.columns)))
    (reduced,) = _thinned(own, ("matrix",), every)
    columns = np.zeros((*reduced.shape[:2], len(torque_model.columns)))
    columns[..., own.structure.base.independent] = reduced
    return columns


def _thinned(problem: Problem, names: tuple[str, ...], every: int) -> list[Array]:
    """Every k-th row of these arrays of the equations."""
    parts: list[list[Array]] = [[] for _ in names]
    position = 0
    for rows in problem.rows():
        first = -position % every
        for part, name in zip(parts, names, strict=True):
            part.append(getattr(rows, name)[first::every].copy())
        position += len(rows)
    return [np.concatenate(part) for part in parts]
