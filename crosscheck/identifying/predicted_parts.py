"""Predicted rows of recordings that do not fit into memory: sums over all of them, curves of their beginnings."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np

from crosscheck.identifying.results.identified_model import HeldOutPrediction, PieceSquares, TorqueCurve
from crosscheck.recordings import PartitionedRecording
from graphdyn.identification import MIN_MOVING_SPEED, Problem, own_rows
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False, kw_only=True)
class PredictedParts(HeldOutPrediction):
    """Predicted rows in parts.

    problem: of a PartitionedRecording; excerpt: the same of rows that fit into memory, for the curves
    """

    excerpt: HeldOutPrediction

    @property
    def n_rows(self) -> int:
        """Number of rows as recorded, including those at the borders of the filter."""
        data = self.problem.data
        assert isinstance(data, PartitionedRecording)
        return data.n_rows

    @property
    def period(self) -> float:
        return self.excerpt.period

    def squares(self, pieces: int) -> PieceSquares:
        """Sums of squares, with each part as a piece, of which there are enough."""
        return self._squares

    def curves(self, method: str) -> list[TorqueCurve]:
        """Curves of the excerpt."""
        return self.excerpt.curves(method)

    @cached_property
    def _squares(self) -> PieceSquares:
        data = self.problem.data
        assert isinstance(data, PartitionedRecording)
        x = self.problem.structure.base.matrix @ np.array(list(self.parameters.values())).T
        parts = [part for _, part in data.each_part(self.problem, partial(_squares_of_part, x))]
        sums = np.stack([sums for sums, _ in parts], axis=2)
        named = [dict(zip(self.parameters, of_rows, strict=False)) for of_rows in sums]
        return PieceSquares(named[0], named[1], sums[0, -1], sums[1, -1], np.sum([rows for _, rows in parts], axis=0))


def _squares_of_part(x: Array, problem: Problem, own: slice) -> tuple[Array, Array]:
    """Squares of the errors of every method and of the torque, over all rows and over the moving ones (2, m + 1, n).

    The second array has the numbers of moving rows (n,)."""
    sums = np.zeros((2, x.shape[1] + 1, problem.n_joints))
    moving_rows = np.zeros(problem.n_joints)
    for rows in own_rows(problem, own):
        errors = rows.matrix @ x - rows.right[..., None]
        squares = np.concatenate([errors**2, rows.measured[..., None] ** 2], axis=-1)
        moves = np.abs(rows.velocity) > MIN_MOVING_SPEED
        sums[0] += squares.sum(axis=0).T
        sums[1] += np.sum(squares * moves[..., None], axis=0).T
        moving_rows += moves.sum(axis=0)
    return sums, moving_rows
