"""Least squares with plausible parameters: the fit that decides on the data quality of a recording.

    min Σ_j ‖W_j x - τ_j‖² / e_j²,    m ≥ 0, ∫x² dm, ∫y² dm, ∫z² dm ≥ 0 of every body, F_v, F_c, I_a ≥ 0

These bounds are the diagonal of the pseudo-inertia matrix. They relax the linear matrix inequalities of physically
consistent bodies, so that a solver for nonnegative least squares takes milliseconds. Without them a reversed torque
fits as well as the right one, with bodies of negative mass and friction that drives. The fit uses no CAD values, so a
URDF whose inertials are placeholders will do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.least_squares import orthonormal_basis, triangle
from graphdyn.identification.bodies.unknown_bodies import NONNEGATIVE_TERMS
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import Payload, RigidBodies
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import PARAMETER_NAMES

MIN_RESIDUAL = 1e-3
"""Relative residual below which a joint counts as fitted: no drive is known better."""

SECOND_MOMENT_COLUMNS = [PARAMETER_NAMES.index(name) for name in ("I_xx", "I_yy", "I_zz")]
FROM_SECOND_MOMENTS = np.ones((3, 3)) - np.eye(3)
"""Matrix from the second moments of mass to the moments of inertia: I_xx = ∫(y² + z²) dm, and so on."""

MAX_STEPS_PER_COLUMN = 30
"""Largest number of steps of the solver for each column; it takes one or two."""


@dataclass(frozen=True, eq=False)
class Bounds:
    """Bounded coordinates y: x = to_parameters y (p, p), and which y cannot be negative (p,)."""

    to_parameters: Array
    nonnegative: NDArray[np.bool_]

    @classmethod
    def of(cls, torque_model: TorqueModel) -> Bounds:
        p = len(torque_model.columns)
        matrix, nonnegative = np.eye(p), np.zeros(p, dtype=bool)
        for term, columns in torque_model.parts:
            if isinstance(term, RigidBodies | Payload):
                for body in range(columns.start, columns.stop, BODY_PARAMETERS):
                    moments = body + np.array(SECOND_MOMENT_COLUMNS)
                    matrix[np.ix_(moments, moments)] = FROM_SECOND_MOMENTS
                    nonnegative[[body, *moments]] = True
            elif isinstance(term, NONNEGATIVE_TERMS):
                nonnegative[columns] = True
        return cls(matrix, nonnegative)

    def extended(self, columns: int, *, body: bool) -> Bounds:
        """The bounds with further parameters, which are free but for the mass of a body, the first of them."""
        p = len(self.nonnegative)
        matrix, nonnegative = np.eye(p + columns), np.zeros(p + columns, dtype=bool)
        matrix[:p, :p], nonnegative[:p], nonnegative[p] = self.to_parameters, self.nonnegative, body
        return Bounds(matrix, nonnegative)


class BoundedFit:
    """The equations of a torque model over N samples, fitted to one measured torque after another.

    The joints are weighted by the residual that they have without bounds, so that each counts relative to its noise.
    """

    def __init__(self, matrix: Array, known: Array, kept: NDArray[np.bool_], bounds: Bounds):
        """Prepare the fit of W x + known.

        matrix: W (N, n, p); known: torque (N, n); kept: which rows count for which joint (N, n)

        Raises InvalidInput for NaN and infinity.
        """
        self.matrix, self.known, self.kept, self._bounds = matrix, known, kept, bounds
        if not (np.all(np.isfinite(matrix)) and np.all(np.isfinite(known))):
            raise InvalidInput("a term of the torque, or a known torque, is not finite for the motion of the recording")
        self._parts: list[tuple[NDArray[np.intp], Array, Array]] = []
        for j, kept in enumerate(self.kept.T):
            w = self.matrix[kept, j]
            seen = np.flatnonzero(np.any(w != 0, axis=0))
            q, r = np.linalg.qr(w[:, seen])
            self._parts.append((seen, q, r))

    @classmethod
    def of(cls, torque_model: TorqueModel, samples: Samples, kept: NDArray[np.bool_]) -> BoundedFit:
        return cls(torque_model.rows(samples), torque_model.known_torque(samples), kept, Bounds.of(torque_model))

    def part(self, rows: slice | NDArray[np.intp] | NDArray[np.bool_]) -> BoundedFit:
        """The fit of some of the samples."""
        return BoundedFit(self.matrix[rows], self.known[rows], self.kept[rows], self._bounds)

    def extended(self, columns: Array, *, body: bool) -> BoundedFit:
        """The fit with further columns (N, n, c); of a body the first is that of its mass, which is not negative."""
        matrix = np.concatenate([self.matrix, columns], axis=-1)
        return BoundedFit(matrix, self.known, self.kept, self._bounds.extended(columns.shape[-1], body=body))

    def errors(self, tau: Array, *, bounded: bool = True) -> Array:
        """‖e_j‖ / ‖τ_j‖ of every joint (n,), not below MIN_RESIDUAL. tau: measured torque (N, n)."""
        factors = self._factors(tau)
        return _errors(factors, self._solved(factors, bounded))

    def parameters(self, tau: Array, *, bounded: bool = True) -> Array:
        """Fitted parameters x (p,)."""
        return self._solved(self._factors(tau), bounded)

    def residual(self, tau: Array, x: Array) -> Array:
        """Residual W x + known - τ (N, n); NaN in rows that do not count."""
        return np.where(self.kept, self.matrix @ x + self.known - tau, np.nan)

    def _solved(self, factors: list[Array], bounded: bool) -> Array:
        x = _solution(factors, np.ones(len(factors)))
        weights = _errors(factors, x)
        return self._bounded_solution(factors, weights) if bounded else _solution(factors, weights)

    def _factors(self, tau: Array) -> list[Array]:
        """Factors [R | z] per joint with ‖R x - z‖ = ‖e_j‖ / ‖τ_j‖."""
        right = tau - self.known
        factors = []
        for j, (seen, q, r) in enumerate(self._parts):
            y = right[self.kept[:, j], j]
            z = q.T @ y
            factor = np.zeros((len(r) + 1, self.matrix.shape[-1] + 1))
            factor[:-1, seen], factor[:-1, -1] = r, z
            factor[-1, -1] = np.sqrt(max(0.0, float(y @ y - z @ z)))
            size = float(np.linalg.norm(tau[self.kept[:, j], j]))
            factors.append(factor / (size or 1.0))
        return factors

    def _bounded_solution(self, factors: list[Array], weights: Array) -> Array:
        """Solution with bounds: the free columns are projected out first, and the bounded ones explain the rest."""
        a, b = _weighted(factors, weights)
        a = a @ self._bounds.to_parameters
        length = np.linalg.norm(a, axis=0)
        seen = length > RANK_TOLERANCE * length.max(initial=0.0)
        unit = a / np.where(seen, length, np.inf)
        held = self._bounds.nonnegative & seen
        free = ~self._bounds.nonnegative & seen
        imitated = orthonormal_basis(unit[:, free], RANK_TOLERANCE)
        left = unit[:, held] - imitated @ (imitated.T @ unit[:, held])
        left[:, np.linalg.norm(left, axis=0) <= RANK_TOLERANCE] = 0.0
        y = np.zeros(len(seen))
        y[held] = _nonnegative(left, b - imitated @ (imitated.T @ b))
        y[free] = np.linalg.lstsq(unit[:, free], b - unit[:, held] @ y[held], rcond=RANK_TOLERANCE)[0]
        y[seen] /= length[seen]
        return np.asarray(self._bounds.to_parameters @ y)


def _nonnegative(a: Array, b: Array) -> Array:
    """x ≥ 0 with the smallest ‖A x - b‖; zero, a poor fit, if the solver does not converge."""
    from scipy.optimize import nnls

    if not a.size:  # scipy.optimize.nnls frees the memory of an empty matrix twice
        return np.zeros(a.shape[1])
    try:
        found, _ = nnls(a, b, maxiter=MAX_STEPS_PER_COLUMN * a.shape[1])
    except RuntimeError:
        return np.zeros(a.shape[1])
    return np.asarray(found)


def _weighted(factors: list[Array], weights: Array) -> tuple[Array, Array]:
    stacked = np.concatenate([factor / weight for factor, weight in zip(factors, weights, strict=True)])
    factor = triangle(stacked)
    return factor[:, :-1], factor[:, -1]


def _solution(factors: list[Array], weights: Array) -> Array:
    a, b = _weighted(factors, weights)
    length = np.linalg.norm(a, axis=0)
    length[length <= RANK_TOLERANCE * length.max(initial=0.0)] = np.inf
    return np.asarray(np.linalg.lstsq(a / length, b, rcond=RANK_TOLERANCE)[0] / length)


def _errors(factors: list[Array], x: Array) -> Array:
    sizes = [np.linalg.norm(factor[:, :-1] @ x - factor[:, -1]) for factor in factors]
    return np.maximum(sizes, MIN_RESIDUAL)


MIN_CONTRADICTION, MIN_WORTH = 2.0, 0.2
"""Residual of the common fit from which the halves of a recording contradict each other: as a multiple of that of their
separate fits, and as a fraction of the torque."""


def halves_apart(tau: Array, fit: BoundedFit) -> Array:
    """Errors of the common and of the separate fit, of the first and of the second half (2, 2, n)."""
    x, middle = fit.parameters(tau), len(tau) // 2
    errors = []
    for rows in (slice(None, middle), slice(middle, None)):
        half, own = tau[rows], fit.part(rows)
        size = np.linalg.norm(np.where(own.kept, half, 0.0), axis=0)
        common = np.linalg.norm(np.nan_to_num(own.residual(half, x)), axis=0) / np.where(size > 0, size, 1.0)
        errors.append([common, own.errors(half)])
    return np.array(errors)


def contradictions(halves: Array) -> NDArray[np.bool_]:
    """Halves and joints where a recording contradicts its other half (2, n). halves: of RecordingQuality."""
    common, own = halves[:, 0], halves[:, 1]
    return np.asarray(common > np.maximum(MIN_CONTRADICTION * own, MIN_WORTH))
