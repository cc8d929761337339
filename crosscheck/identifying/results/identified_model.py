"""One torque model, identified with several methods: its fit, its predictions, its links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.identifying.choosing.ladder import Ladder
from crosscheck.recordings import PartitionedRecording
from crosscheck.reference.subject import Subject
from graphdyn.display import short_repr
from graphdyn.identification import (
    MIN_MOVING_SPEED,
    ContradictedMass,
    MethodComparison,
    MethodResult,
    Partitioned,
    PhysicalLimits,
    Problem,
    ResidualStatistics,
    TorqueModel,
    Tuned,
    contradicted_masses,
    one_thread,
    own_rows,
)
from graphdyn.identification.terms import CarriesKnownBodies, KnownPayload
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
class TorqueCurve:
    """Measured and predicted torque of one interval of time.

    t (N,) [s]; measured, predicted (N, n) [N m or N]; velocity (N, n) [rad/s or m/s]
    """

    t: Array
    measured: Array
    predicted: Array
    velocity: Array


@dataclass(frozen=True, eq=False)
class PieceSquares:
    """Sums of squares over consecutive parts of some rows.

    everything, moving: of the errors of every method, over all rows and over those that move (K, n)
    measured, measured_moving: of the measured torque, likewise (K, n); moving_rows: how many rows move (n,)
    """

    everything: Mapping[str, Array]
    moving: Mapping[str, Array]
    measured: Array
    measured_moving: Array
    moving_rows: Array


@dataclass(frozen=True, eq=False)
class HeldOutPrediction:
    """Rows that were predicted, with the parameters of every method that has a result.

    times: of the rows, interval by interval (N_k,) [s]; parameters: by method (p,); statistics: by method
    name: of the rows
    """

    problem: Problem
    times: Sequence[Array]
    parameters: Mapping[str, Array]
    statistics: Mapping[str, ResidualStatistics]
    name: str = ""

    @property
    def n_rows(self) -> int:
        """Number of these rows."""
        return sum(map(len, self.times))

    @property
    def period(self) -> float:
        """Time between two rows, NaN for a single one [s]."""
        longest = max(self.times, key=len)
        return float(np.median(np.diff(longest))) if len(longest) > 1 else float("nan")

    def squares(self, pieces: int) -> PieceSquares:
        """Squares of the torques and their errors, summed over this number of consecutive parts of the rows."""
        matrix = self.problem.structure.base.matrix
        x = np.array(list(self.parameters.values())).T
        total, first = sum(map(len, self.times)), 0
        sums = np.zeros((2, len(self.parameters) + 1, pieces, self.problem.n_joints))
        moving_rows = np.zeros(self.problem.n_joints)
        for rows in self.problem.rows():
            piece = np.arange(first, first + len(rows)) * pieces // total
            squares, moves = _squares(rows, matrix @ x)
            for part in np.unique(piece):
                sums[:, :, part] += squares[:, piece == part].sum(axis=1).swapaxes(1, 2)
            moving_rows += moves.sum(axis=0)
            first += len(rows)
        return self._named(sums, moving_rows)

    def _named(self, sums: Array, moving_rows: Array) -> PieceSquares:
        """Sums over all rows, and over those that move, of every method and of the torque (2, m + 1, K, n), by name."""
        everything, moving = (dict(zip(self.parameters, of_rows, strict=False)) for of_rows in sums)
        return PieceSquares(everything, moving, sums[0, -1], sums[1, -1], moving_rows)

    def curves(self, method: str) -> list[TorqueCurve]:
        """One curve per interval."""
        x = self.problem.structure.base.matrix @ self.parameters[method]
        parts = [  # in chunks, because the regressor of a long recording does not fit into memory
            (rows.measured, rows.measured + rows.matrix @ x - rows.right, rows.velocity) for rows in self.problem.rows()
        ]
        whole = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        borders = np.cumsum([len(t) for t in self.times])[:-1]
        pieces = zip(*(np.split(array, borders) for array in whole), strict=True)
        return [TorqueCurve(t, *piece) for t, piece in zip(self.times, pieces, strict=True)]


@dataclass(frozen=True, eq=False, kw_only=True)
@short_repr
class IdentifiedModel:
    """One torque model, fitted with several methods.

    subject: the robot; its parameters are the prior
    fit: the rows of the fit
    trials: rows that were predicted, by which results are chosen
    aside: rows that were predicted and have no influence on the choice
    comparison: every method; held-out errors are those of all trials together
    exogeneity: of the regressor, as text: the result of the Durbin-Wu-Hausman test, or why it is not made
    name: of the torque model, empty where there is only one
    cad_of: name of the torque model with unknown links and the same drives, if the links of this one are those of CAD;
        None for a model that was asked for
    settings: of its terms that were found together with the parameters, from all fitted rows
    ladder: how the terms of its drives were chosen; None where they were given
    limits: of the links, for methods that keep any
    """

    subject: Subject
    torque_model: TorqueModel
    fit: HeldOutPrediction
    trials: tuple[HeldOutPrediction, ...]
    comparison: MethodComparison
    exogeneity: str
    aside: tuple[HeldOutPrediction, ...] = ()
    name: str = ""
    cad_of: str | None = None
    settings: tuple[Tuned, ...] = ()
    ladder: Ladder | None = None
    limits: PhysicalLimits = field(default_factory=PhysicalLimits)

    @property
    def problem(self) -> Problem:
        """The equations of the fit."""
        return self.fit.problem

    @property
    def prior_base_values(self) -> Array:
        """Base parameters of the robot as given; zero for those of the drives (r,)."""
        return self.problem.base.values(self.torque_model.prior())

    @cached_property
    def contradicted_masses(self) -> tuple[ContradictedMass, ...]:
        """Masses of CAD that the recording contradicts; none for known links."""
        with one_thread():
            return contradicted_masses(self.problem, self.limits)

    def fitted_errors(self, result: MethodResult) -> Array:
        """‖e‖ / ‖τ‖ per joint over the rows that were fitted (n,); the result must have an estimate."""
        assert result.base_values is not None
        return np.asarray(np.sqrt(self.problem.equations.residual_squares(result.base_values) / self._fitted_squares))

    @cached_property
    def _fitted_squares(self) -> Array:
        """‖τ‖² of each joint over the rows that were fitted, known torques included (n,)."""
        if isinstance(self.problem.data, Partitioned):
            parts = self.problem.data.each_part(self.problem, _measured_squares)
            return np.asarray(sum(part for _, part in parts))
        return _measured_squares(self.problem, slice(None))

    def body_parameters(self, result: MethodResult) -> Array:
        """Ten parameters per link (n, 10), with an unknown payload, without a known one; the result has an estimate."""
        assert result.estimate is not None
        total = self.torque_model.inertial_parameters(result.estimate.parameters)
        for term in self.torque_model.known:
            if isinstance(term, KnownPayload) and isinstance(term, CarriesKnownBodies):
                total = total - term.known_inertial_parameters(self.torque_model.model)
        return total.reshape(-1, 10)

    def row_name(self, result: MethodResult) -> str:
        """Name of a result of this model in tables of several models."""
        return f"{self.name}: {result.name}" if self.name else result.name


def _measured_squares(problem: Problem, own: slice) -> Array:
    """‖τ‖² of each joint over the equations that count (n,)."""
    rows = problem.rows() if own == slice(None) else own_rows(problem, own)
    return np.asarray(sum(np.sum(np.where(part.kept, part.measured, 0.0) ** 2, axis=0) for part in rows))


@dataclass(frozen=True, eq=False)
@short_repr
class Candidate:
    """A row of the comparison.

    name: as in the tables, unlike those of all others
    model: torque model; result: of one method on it
    """

    name: str
    model: IdentifiedModel
    result: MethodResult


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
        return self._named(np.stack([sums for sums, _ in parts], axis=2), np.sum([rows for _, rows in parts], axis=0))


def _squares_of_part(x: Array, problem: Problem, own: slice) -> tuple[Array, Array]:
    """Squares of the errors of every method and of the torque, over all rows and over the moving ones (2, m + 1, n).

    The second array has the numbers of moving rows (n,)."""
    sums = np.zeros((2, x.shape[1] + 1, problem.n_joints))
    moving_rows = np.zeros(problem.n_joints)
    for rows in own_rows(problem, own):
        squares, moves = _squares(rows, x)
        sums += squares.sum(axis=1).swapaxes(1, 2)
        moving_rows += moves.sum(axis=0)
    return sums, moving_rows


def _squares(rows: Any, x: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Squares of the errors of every method and of the torque in all rows, zero in the second item for those that do
    not move (2, N, n, m + 1), and which move (N, n). x: base parameters of every method (r, m)"""
    errors = rows.matrix @ x - rows.right[..., None]
    squares = np.concatenate([errors**2, rows.measured[..., None] ** 2], axis=-1)
    moves = np.abs(rows.velocity) > MIN_MOVING_SPEED
    return np.stack([squares, squares * moves[..., None]]), moves
