"""Least squares without bounds on few rows, from Gram matrices: which changes are worth a fit within bounds.

The criterion Σ_j log ‖e_j‖ of such a fit is never above that of the fit within bounds (bounded_fit.py), and takes a
tenth of the time: without bounds the base parameters suffice. A change whose free fit is not good enough needs no
other.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.data.samples import Samples, joined_samples
from graphdyn.identification.data_quality.fits.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.problem.torque_model import TorqueModel, structure
from graphdyn.layout import Array

log = logging.getLogger(__name__)

ROUNDING_SHARE = 1e-8
"""Length of a column, relative to the longest, below which it is zero up to rounding."""

GRAM_RIDGE = 1e-10
"""Added to the diagonal of the Gram matrix of unit columns, which makes dependent columns solvable."""

ROWS_AT_ONCE = 2000
"""Number of rows whose regressors are computed together: compiled code needs a thousand samples."""

Motion = tuple[TorqueModel, Samples, NDArray[np.bool_]]
"""A torque model, samples, and which of their rows count for which joint (N, n)."""


def free_misfits(motions: Sequence[Motion]) -> list[float]:
    """Σ_j log(‖e_j‖ / ‖τ_j‖) of every motion; ∞ for a motion that a user's term or torque refuses.

    Motions of one torque model that follow each other are computed together.
    """
    found: list[float] = []
    start = 0
    while start < len(motions):
        model, first, _ = motions[start]
        stop = start + 1
        while stop < len(motions) and motions[stop][0] is model and (stop - start + 1) * len(first) <= ROWS_AT_ONCE:
            stop += 1
        log.info("changed recording %d of %d", start + 1, len(motions))
        found += _of_one_model(model, motions[start:stop])
        start = stop
    return found


def _of_one_model(model: TorqueModel, motions: Sequence[Motion]) -> list[float]:
    try:
        samples = joined_samples([samples for _, samples, _ in motions], slice(None))
        matrices = np.split(model.rows(samples, structure(model).base.independent), len(motions))
        known = np.split(model.known_torque(samples), len(motions))
    except Exception:
        if len(motions) == 1:
            return [np.inf]
        return [_of_one_model(model, [motion])[0] for motion in motions]
    parts = zip(matrices, known, motions, strict=True)
    return [gram_misfit(grams(w, own.tau - at, own.tau, kept)) for w, at, (_, own, kept) in parts]


def grams(matrix: Array, right: Array, tau: Array, kept: NDArray[np.bool_]) -> Array:
    """Gram matrices of [W_j | right_j] / ‖τ_j‖ for every joint (n, p + 1, p + 1).

    matrix: W (N, n, p); right, tau: (N, n); kept: rows that count for each joint (N, n)
    """
    n, p = matrix.shape[1:]
    found = np.zeros((n, p + 1, p + 1))
    for j, rows in enumerate(kept.T):
        if rows.all():
            own_matrix, own_right, own_tau = matrix[:, j], right[:, j], tau[:, j]
        else:
            own_matrix, own_right, own_tau = matrix[rows, j], right[rows, j], tau[rows, j]
        acting = np.flatnonzero(own_matrix.any(axis=0))
        count = len(acting) + bool(own_right.any())
        transposed = np.empty((count, len(own_matrix)))
        transposed[: len(acting)] = own_matrix.T[acting]
        transposed[len(acting) :] = own_right
        places = np.append(acting, p) if count > len(acting) else acting
        gram = transposed @ transposed.T / (float(np.sum(own_tau**2)) or 1.0)
        found[j, places[:, None], places] = gram
    return found


class FreeFit:
    """The fit without bounds of samples whose torque is replaced, or explained by further columns."""

    def __init__(self, torque_model: TorqueModel, fit: BoundedFit, tau: Array):
        """Prepare the fit of samples from their fit within bounds. tau: measured (N, n)"""
        self._matrix = fit.matrix[..., structure(torque_model).base.independent]
        self._fit, self._tau = fit, tau
        self._grams = grams(self._matrix, tau - fit.known, tau, fit.kept)

    @cached_property
    def _equations(self) -> list[Array]:
        """[W_j | right_j] of the rows that count, joint by joint."""
        right = self._tau - self._fit.known
        kept = enumerate(self._fit.kept.T)
        return [np.column_stack([self._matrix[rows, j], right[rows, j]]) for j, rows in kept]

    def misfit_of_torque(self, joint: int, torque: Array) -> float:
        """Σ_j log ‖e_j‖ with another torque (N,) of one joint."""
        whole, one = self._grams.copy(), slice(joint, joint + 1)
        right = torque - self._fit.known[:, joint]
        whole[one] = grams(self._matrix[:, one], right[:, None], torque[:, None], self._fit.kept[:, one])
        return gram_misfit(whole)

    def misfit_of_torques(self, torques: Array) -> float:
        """Σ_j log ‖e_j‖ with other torques (N, n)."""
        return gram_misfit(grams(self._matrix, torques - self._fit.known, torques, self._fit.kept))

    def misfit_with(self, columns: Array) -> float:
        """Σ_j log ‖e_j‖ with further columns (N, n, c)."""
        n, p, c = len(self._grams), self._matrix.shape[-1], columns.shape[-1]
        whole = np.zeros((n, p + c + 1, p + c + 1))
        old, new = np.append(np.arange(p), p + c), np.arange(p, p + c)
        whole[:, old[:, None], old] = self._grams
        for j, rows in enumerate(self._fit.kept.T):
            own = columns[rows, j]
            if own.any():
                size = float(np.sum(self._tau[rows, j] ** 2)) or 1.0
                beside = own.T @ self._equations[j] / size
                whole[j, p : p + c, p : p + c] = own.T @ own / size
                whole[j, new[:, None], old] = beside
                whole[j, old[:, None], new] = beside.T
        return gram_misfit(whole)


def gram_misfit(matrices: Array) -> float:
    """Σ_j log ‖e_j‖ of the fit in which each joint is weighted by its residual.

    matrices: of grams (n, p + 1, p + 1)
    """
    n, p = len(matrices), matrices.shape[-1] - 1
    if not np.isfinite(matrices).all():
        return np.inf
    flat, diagonal = matrices.reshape(n, -1), np.arange(p)
    weights, squares, solution = np.ones(n), np.ones(n), np.full(p + 1, -1.0)
    for _ in range(2):
        whole = (weights @ flat).reshape(p + 1, p + 1)
        length = np.sqrt(whole[diagonal, diagonal])
        length[length <= ROUNDING_SHARE * length.max(initial=0.0)] = np.inf
        unit = whole[:p, :p] / (length[:, None] * length)
        unit[diagonal, diagonal] += GRAM_RIDGE
        solution[:p] = np.linalg.solve(unit, whole[:p, p] / length) / length
        squares = np.maximum(np.einsum("i,jik,k->j", solution, matrices, solution), MIN_RESIDUAL**2)
        weights = 1 / squares
    return 0.5 * float(np.sum(np.log(squares)))
