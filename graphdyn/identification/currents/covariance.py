"""The covariance of a fit of currents: a jackknife over time blocks, and what the known numbers leave open.

A standard deviation from B blocks is itself uncertain. It is enlarged by the quantile of Student's t distribution, so
that twice the deviation covers as much as with a normal distribution. The degrees of freedom are those of Satterthwaite
(Biometrics Bulletin 2, 1946): as many as blocks, where all contribute alike, and fewer where a few of them hold
most of what is known of a parameter.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from graphdyn.identification.algebra.least_squares import square_triangle
from graphdyn.identification.currents.equations import CurrentEquations
from graphdyn.identification.statistics.correlation import KNOWN_SHARE
from graphdyn.layout import Array

UNDETERMINED = 1e-7
"""Singular value of the equations, columns at unit length, relative to the largest, below which a combination is
undetermined: gains without anything known have 1e-10, the weakest gain of a moving joint 1e-4."""


TWO_SIGMA = 0.9772498680518208
"""Probability that a normal variable is below two standard deviations."""


class Covariance(NamedTuple):
    """Covariances of the unknowns (size, size); infinite variances of what nothing determines, or one block alone.

    measured: from the time blocks, with the quantiles of few blocks
    expected: for the noise of every joint; its correlations do not scatter as those of few blocks do
    """

    measured: Array
    expected: Array


def current_covariance(equations: CurrentEquations, known: tuple[Array, Array], noise: Array, x: Array) -> Covariance:
    """Covariances of the unknowns x.

    known: rows and right side of what is known; noise: of every recording and joint (k, n)
    """
    steps = [equations.derivatives(k, x) for k in range(len(noise))]
    totals = zip(equations.totals, noise, steps, strict=True)
    parts = [(_weighted(total.factors, own)[..., :-1] @ step).reshape(-1, len(x)) for total, own, step in totals]
    jacobian = np.concatenate([*parts, known[0]])
    length = np.linalg.norm(jacobian, axis=0)
    length = np.where(length > 0, length, 1.0)
    _, s, v_t = np.linalg.svd(square_triangle(jacobian / length))
    kept = s > UNDETERMINED * s[0]
    axes = v_t[kept].T / s[kept] / length[:, None]  # combinations that are determined, with unit information (size, m)
    stated = axes @ (known[0] @ axes).T
    measured, alone = stated @ stated.T, np.zeros(len(x), dtype=bool)
    variance, uncertainty = np.diagonal(measured).copy(), np.zeros(len(x))
    for k, recording in enumerate(equations.recordings):
        changes = []
        values, along = equations.currents(k, x), steps[k] @ axes
        for block in recording.blocks:
            w = _weighted(block.factors, noise[k])
            j = (w[..., :-1] @ along).reshape(-1, axes.shape[1])
            residual = (np.einsum("jrb,jb->jr", w[..., :-1], values) - w[..., -1]).ravel()
            left, vectors = np.linalg.eigh(np.eye(axes.shape[1]) - j.T @ j)  # information of all else
            others = left > KNOWN_SHARE
            moved = (axes @ (vectors[:, others] / left[others])) @ (j @ vectors[:, others]).T  # by unit noise
            changes.append(moved @ residual)
            expected = np.sum(moved**2, axis=1)
            variance, uncertainty = variance + expected, uncertainty + expected**2
            share = axes @ vectors[:, ~others]
            alone |= np.sum(share**2, axis=1) > KNOWN_SHARE * np.sum(axes**2, axis=1)
        s_b = np.array(changes)
        measured += s_b.T @ s_b * (len(s_b) - 1) / len(s_b)
    enlarged = _enlarged(variance, uncertainty)
    lost = alone | (np.sum(v_t[~kept] ** 2, axis=0) > UNDETERMINED)
    found = []
    for covariance in (measured * enlarged * enlarged[:, None], axes @ axes.T):
        covariance[lost, :] = covariance[:, lost] = 0.0
        covariance[lost, lost] = np.inf
        found.append(covariance)
    return Covariance(*found)


def _enlarged(variance: Array, uncertainty: Array) -> Array:
    """Factors of standard deviations (size,): Student's quantile over the normal one.

    variance: expected; uncertainty: sum of the squares of its contributions   (size,)
    """
    from scipy.stats import t  # imported where first used: import graphdyn stays light

    freedom = np.full(len(variance), np.inf)
    np.divide(variance**2, uncertainty, out=freedom, where=uncertainty > 0)
    return np.asarray(t.ppf(TWO_SIGMA, freedom) / 2)


def _weighted(factors: Array, noise: Array) -> Array:
    """Factors (n, rows, b + 1) in units of the noise (n,)."""
    found: Array = factors / noise[:, None, None]
    return found
