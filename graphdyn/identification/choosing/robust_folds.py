"""Robust fits of physically consistent bodies and drives, to all rows and to all but each fold, of many torque models.

    minimize Σ_g Σ_t 2 ρ(e_gt / σ_g) + strength Σ_i d(P_i(x), P₀_i)

with Huber's ρ and the entropic divergence d, as RobustConsistent("entropic") has it. Here a fit takes some
hundredths of a second: the prior has a fixed strength, Newton's method solves the program, all folds share the
weights of the fit to all rows, and every few rows of a recording are enough to tell which terms predict better.

Huber, Annals of Mathematical Statistics 35(1), 1964; Lee, Wensing and Park, IEEE Transactions on Robotics 36(2), 2020.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.bodies.unknown_bodies import NONNEGATIVE_TERMS, unknown_bodies
from graphdyn.identification.choosing.body_newton import BodyNewton
from graphdyn.identification.choosing.fold_errors import FoldErrors
from graphdyn.identification.choosing.term_columns import TermColumns
from graphdyn.identification.consistent.coordinates import SYMMETRIC_BASIS, upper_factor
from graphdyn.identification.estimators.reweighted import NORMAL_MEDIAN, huber
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.statistics.correlation import CorrelationLength
from graphdyn.identification.terms import Payload, RigidBodies, Term
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import parameters_from_pseudo_inertia

FOLD_PRIOR_STRENGTH = 10.0
"""Strength of the entropic prior: links may differ from CAD by half and more, and directions that the recording hardly
shows do not scatter from fold to fold. With 1 the folds of a KUKA KR300 are 6 % worse; with 100 a UR10 has no load
friction."""

MAX_FOLD_REWEIGHTINGS = 6

SETTLED_SHARE = 0.03
"""Root mean square change of a joint's predicted torque, relative to its noise, at which the weights have settled."""

MIN_FOLD_NOISE_SHARE = 1e-4
"""Smallest noise of a joint relative to its torque: exact data would have weights without bound."""

START_SHARE = 0.05
"""Start of friction, as a part of the measured torque."""


@dataclass(frozen=True, eq=False)
class FoldedFit:
    """A torque model, fitted to all rows and to all but each fold.

    names: of the additions
    bodies: coordinates of the bodies, for the next model   (10 n_bodies,)
    residuals: of the fit to all rows                       (N, n)  [N m or N]
    scale: noise of every joint, from the median            (n,)    [N m or N]
    errors: of each fold, predicted from the others
    """

    names: tuple[str, ...]
    bodies: Array
    residuals: Array
    scale: Array
    errors: FoldErrors

    @property
    def correlation_times(self) -> float:
        """Length of the rows in correlation times of the residual, for the joint with the longest one."""
        lengths = CorrelationLength(self.residuals.shape[1], 1)
        lengths.add(self.residuals[..., None], np.ones(self.residuals.shape, dtype=bool))
        longest = float(np.nanmax(lengths.samples(), initial=0.0))
        return len(self.residuals) / longest if longest > 0 else float("inf")


class RobustFolds:
    """Fits of the fixed terms together with any of the additions, over the same folds."""

    def __init__(
        self,
        columns: TermColumns,
        additions: dict[str, Term],
        folds: Sequence[tuple[NDArray[np.bool_], NDArray[np.bool_]]],
        strength: float = FOLD_PRIOR_STRENGTH,
    ):
        """Prepare the fits.

        additions: the terms of columns.additions; folds: rows that are fitted, and rows that are predicted, K of (N,)
        Raises InvalidInput if no unknown body of the robot has a mass.
        """
        self.columns, self._strength = columns, strength
        self._tests = [test for _, test in folds]
        self._left_out = [~train for train, _ in folds]
        size = np.sqrt(np.mean(columns.right**2, axis=0))
        self._size = np.where(size > 0, size, 1.0)
        self._to_base, self._n_bodies, fixed_nonnegative = _coordinates(columns, self._size)
        self._fixed_nonnegative = fixed_nonnegative
        self._nonnegative = {name: isinstance(term, NONNEGATIVE_TERMS) for name, term in additions.items()}
        self._additions = {name: _at_unit_torque(part, self._size) for name, part in columns.additions.items()}

    def fit(self, names: Sequence[str], start: FoldedFit | None = None) -> FoldedFit:
        """Fit the fixed terms and these additions, from the weights and bodies of another model if one is given."""
        parts = [self._additions[name] for name in names]
        matrix = np.concatenate([self.columns.matrix, *parts], axis=-1)
        nonnegative = np.concatenate(
            [self._fixed_nonnegative]
            + [np.full(part.shape[-1], self._nonnegative[name]) for name, part in zip(names, parts, strict=True)]
        )
        newton = BodyNewton(self._n_bodies, nonnegative, self._strength)
        to_columns = _block_diagonal(self._to_base, matrix.shape[-1] - len(self._to_base))
        u = newton.start(START_SHARE)
        if start is None:
            scale = self._free_noise(matrix)
            weights = self.columns.kept / scale**2
        else:
            u[: newton.width] = start.bodies
            scale, weights = start.scale, self._weights(start.residuals, start.scale)
        sums = _Sums(matrix, self.columns.right, to_columns, self._left_out)
        residuals = np.full(self.columns.right.shape, np.inf)
        for _ in range(MAX_FOLD_REWEIGHTINGS):
            h, g = sums.whole(weights * self.columns.every)
            u = newton.minimum(h[None], g[None], u[None])[0]
            before, residuals = residuals, matrix @ (to_columns @ u) - self.columns.right
            scale = self._noise(residuals)
            weights = self._weights(residuals, scale)
            if self._settled(residuals - before, scale):
                break
        h, g = sums.folds(weights * self.columns.every)
        found = newton.minimum(h, g, np.repeat(u[None], len(h), axis=0))
        ahead = np.full(self.columns.right.shape, np.nan)
        for test, x in zip(self._tests, found, strict=True):
            ahead[test] = matrix[test] @ (to_columns @ x) - self.columns.right[test]
        errors = FoldErrors.of(self.columns, ahead, self._tests)
        return FoldedFit(tuple(names), u[: newton.width], residuals, scale, errors)

    def _weights(self, residuals: Array, scale: Array) -> Array:
        """Huber's weights over the variance, zero for equations that do not count (N, n)."""
        return np.where(self.columns.kept, huber().weight(residuals / scale) / scale**2, 0.0)

    def _noise(self, residuals: Array) -> Array:
        """σ (n,) from the median of |e|."""
        sizes = [
            np.median(np.abs(column[kept])) if kept.any() else np.inf
            for column, kept in zip(residuals.T, self.columns.kept.T, strict=True)
        ]
        return np.maximum(np.array(sizes) / NORMAL_MEDIAN, MIN_FOLD_NOISE_SHARE * self._size)

    def _free_noise(self, matrix: Array) -> Array:
        """σ (n,) from the residual of every joint alone, fitted without bounds."""
        residuals = np.zeros(self.columns.right.shape)
        for j, kept in enumerate(self.columns.kept.T):
            own = matrix[:, j][:, np.any(matrix[:, j] != 0, axis=0)]
            length = np.linalg.norm(own[kept], axis=0)
            unit = own / np.where(length > 0, length, 1.0)
            x, *_ = np.linalg.lstsq(unit[kept], self.columns.right[kept, j], rcond=RANK_TOLERANCE)
            residuals[:, j] = unit @ x - self.columns.right[:, j]
        return self._noise(residuals)

    def _settled(self, change: Array, scale: Array) -> bool:
        counted = np.where(self.columns.kept, change, 0.0)
        return bool(np.all(np.sqrt(np.mean(counted**2, axis=0)) <= SETTLED_SHARE * scale))


class _Sums:
    """Sums Mᵀ Wᵀ w W M and Mᵀ Wᵀ w τ over all rows, and over all but those that each fold leaves out.

    matrix: W (N, n, c); right: τ (N, n); to_columns: M (c, p); left_out: K of (N,)
    """

    def __init__(self, matrix: Array, right: Array, to_columns: Array, left_out: Sequence[NDArray[np.bool_]]):
        self._to_columns, self._left_out, self._width = to_columns, left_out, matrix.shape[-1]
        self._joints = []
        for j in range(matrix.shape[1]):
            seen = np.flatnonzero(np.any(matrix[:, j] != 0, axis=0))
            self._joints.append((seen, np.column_stack([matrix[:, j][:, seen], right[:, j]])))

    def whole(self, weights: Array) -> tuple[Array, Array]:
        """H (p, p), g (p,) over all rows with these weights (N, n)."""
        return self._in_coordinates(self._sum(weights, slice(None)))

    def folds(self, weights: Array) -> tuple[Array, Array]:
        """H (K, p, p), g (K, p) over the rows of each fold's fit."""
        whole = self._sum(weights, slice(None))
        found = [self._in_coordinates(whole - self._sum(weights, rows)) for rows in self._left_out]
        h, g = zip(*found, strict=True)
        return np.array(h), np.array(g)

    def _sum(self, weights: Array, rows: NDArray[np.bool_] | slice) -> Array:
        total = np.zeros((self._width + 1, self._width + 1))
        for j, (seen, own) in enumerate(self._joints):
            part = own[rows]
            places = np.append(seen, self._width)
            total[np.ix_(places, places)] += part.T @ (part * weights[rows, j, None])
        return total

    def _in_coordinates(self, total: Array) -> tuple[Array, Array]:
        m = self._to_columns
        return m.T @ total[:-1, :-1] @ m, m.T @ total[:-1, -1]


def _coordinates(columns: TermColumns, size: Array) -> tuple[Array, int, NDArray[np.bool_]]:
    """Matrix (b, p) from coordinates to base parameters of the fixed terms, their bodies, which others are ≥ 0 (k,)."""
    torque_model = columns.torque_model
    p = len(torque_model.columns)
    bodies = _bodies_of(torque_model)
    prior, slices = bodies or (np.zeros((0, 4, 4)), ())
    in_bodies = np.concatenate([np.arange(part.start, part.stop) for part in slices] or [np.zeros(0, dtype=int)])
    others = np.setdiff1d(np.arange(p), in_bodies)
    to_parameters = np.zeros((p, len(in_bodies) + len(others)))
    for i, (factor, part) in enumerate(zip(upper_factor(prior), slices, strict=True)):
        basis = np.einsum("ai,ijk,bj->kab", factor, SYMMETRIC_BASIS, factor)
        to_parameters[part, BODY_PARAMETERS * i : BODY_PARAMETERS * (i + 1)] = parameters_from_pseudo_inertia(basis).T
    to_parameters[others, np.arange(len(in_bodies), to_parameters.shape[1])] = 1.0
    to_base = columns.base.matrix @ to_parameters
    width = len(in_bodies)
    further = columns.matrix @ to_base[:, width:]
    length = _length(further, size)
    to_base[:, width:] /= np.where(length > 0, length, np.inf)
    nonnegative = np.zeros(p, dtype=bool)
    for term, part in torque_model.parts:
        if isinstance(term, NONNEGATIVE_TERMS):
            nonnegative[part] = True
    return to_base, len(slices), nonnegative[others]


def _bodies_of(torque_model: TorqueModel) -> tuple[Array, Sequence[slice]] | None:
    """Prior and columns of the unknown bodies, None if all are known."""
    if not any(isinstance(term, RigidBodies | Payload) for term in torque_model.terms):
        return None
    bodies = unknown_bodies(torque_model, None)
    return bodies.prior, bodies.columns


def _at_unit_torque(columns: Array, size: Array) -> Array:
    """Columns (N, n, k) scaled so that 1 makes a torque as large as the measured one."""
    length = _length(columns, size)
    return columns / np.where(length > 0, length, np.inf)


def _length(columns: Array, size: Array) -> Array:
    """Root of the sum over the joints of the mean square relative to the torque of the joint (k,)."""
    return np.asarray(np.sqrt(np.sum(np.mean((columns / size[None, :, None]) ** 2, axis=0), axis=0)))


def _block_diagonal(block: Array, more: int) -> Array:
    """The block with a unit matrix behind it."""
    rows, columns = block.shape
    whole = np.zeros((rows + more, columns + more))
    whole[:rows, :columns] = block
    whole[rows:, columns:] = np.eye(more)
    return whole
