"""Statistics of torque residuals: their size, and tests of whiteness.

Ljung and Box, Biometrika 65(2), 1978: Q = N (N + 2) Σ_k r_k² / (N - k) over N_LAGS lags is χ² distributed for white
noise. Durbin and Watson, Biometrika 37, 1950: Σ (e_t - e_{t-1})² / Σ e_t² is 2 for white noise, 0 for a drift.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.identification.data.rows import Rows
from graphdyn.identification.data.samples import Partitioned, merged_in_tree
from graphdyn.identification.problem.problem import Problem, own_rows
from graphdyn.identification.statistics.correlation import CorrelationLength
from graphdyn.layout import Array

MIN_MOVING_SPEED = 0.02
"""Speed below which a joint counts as at rest [rad/s or m/s]: friction is undetermined there."""

N_LAGS = 20
"""Number of lags of the Ljung-Box test; the autocorrelation of a piece does not reach into the next one."""


@dataclass(frozen=True, eq=False)
@short_repr
class ResidualSizes:
    """Sizes of the residuals per joint, over some of the samples.

    count: samples (n,)
    mean: of predicted minus measured torque; NaN without samples (n,) [N m or N]
    rms: root mean square of it; NaN without samples (n,) [N m or N]
    largest: largest absolute value of it; NaN without samples (n,) [N m or N]
    relative: ‖e‖ / ‖τ‖ with the measured torque; NaN without samples (n,)
    """

    count: NDArray[np.int_]
    mean: Array
    rms: Array
    largest: Array
    relative: Array


@dataclass(frozen=True, eq=False)
@short_repr
class ResidualStatistics:
    """Statistics of predicted minus measured torque.

    everything: over all samples
    moving: per joint over the samples with |v_j| > 0.02 rad/s or m/s (MIN_MOVING_SPEED)
    durbin_watson: statistic over all samples, 2 for white noise; NaN without samples (n,)
    ljung_box_p: probability of such a residual if it were white, over all samples; below 0.05 standard deviations for
        white noise are too small; NaN where several trials were put together (n,)
    correlation_length: samples after which the autocorrelation has fallen to 1/e, 0 for a white residual; NaN where
        several trials were put together (n,)
    """

    everything: ResidualSizes
    moving: ResidualSizes
    durbin_watson: Array
    ljung_box_p: Array
    correlation_length: Array

    @property
    def correlation_times(self) -> float:
        """Length of all samples in correlation times, for the joint with the longest one."""
        longest = np.nanmax(self.correlation_length, initial=0.0)
        return float(self.everything.count.max() / longest) if longest > 0 else float("inf")


def residual_statistics(problem: Problem, parameters: Array) -> list[ResidualStatistics]:
    """Statistics for every row of parameters (m, p), in one reading of the recording.

    The equations that min_speed leaves out of the fit are predicted too. For data in parts each part is a piece of its
    own, and the longest correlation in any of them counts.
    """
    x = problem.structure.base.matrix @ np.asarray(parameters, dtype=float).T
    if isinstance(problem.data, Partitioned):
        parts = problem.data.each_part(problem, partial(residuals_of_part, x))
        return merged_in_tree(_Residuals.merge, [part for _, part in parts]).statistics()
    return residuals_of_part(x, problem, slice(0, sys.maxsize)).statistics()


def residuals_of_part(x: Array, problem: Problem, own: slice) -> _Residuals:
    """Residuals of the own equations of a part."""
    sums = _Residuals(problem.n_joints, x.shape[1])
    for rows in own_rows(problem, own):
        sums.add(rows, rows.matrix @ x - rows.right[..., None])
    return sums.finished()


class _Residuals:
    """Sums over the residuals of n joints and m methods."""

    def __init__(self, n: int, m: int):
        self.everything, self.moving = _Sizes(n, m), _Sizes(n, m)
        self.lagged = _Autocorrelation(n, m)
        self.lengths: CorrelationLength | None = CorrelationLength(n, m)
        self.longest = np.full((n, m), np.nan)

    def add(self, rows: Rows, residual: Array) -> None:
        self.everything.add(residual, rows.measured, np.ones(rows.right.shape))
        self.moving.add(residual, rows.measured, (np.abs(rows.velocity) > MIN_MOVING_SPEED).astype(float))
        self.lagged.add(rows, residual)
        assert self.lengths is not None
        self.lengths.add(residual, rows.kept)

    def finished(self) -> _Residuals:
        """The sums without the data needed for further rows: no row can be added any more."""
        if self.lengths is not None:
            self.longest, self.lengths = self.lengths.samples(), None
        return self

    def merge(self, other: _Residuals) -> _Residuals:
        """Sum of both, which must be finished; the longer correlation of the two counts."""
        self.everything.merge(other.everything)
        self.moving.merge(other.moving)
        self.lagged.merge(other.lagged)
        self.longest = np.fmax(self.longest, other.longest)
        return self

    def statistics(self) -> list[ResidualStatistics]:
        """Statistics for every method, of finished sums."""
        longest = self.longest
        tests = self.lagged.durbin_watson(), self.lagged.ljung_box_p(self.everything.count)
        return [
            ResidualStatistics(self.everything.of(k), self.moving.of(k), tests[0][:, k], tests[1][:, k], longest[:, k])
            for k in range(longest.shape[1])
        ]


class _Sizes:
    def __init__(self, n: int, m: int):
        self.count, self.measured = np.zeros(n), np.zeros(n)
        self.sum, self.squares, self.largest = np.zeros((n, m)), np.zeros((n, m)), np.zeros((n, m))

    def add(self, residual: Array, measured: Array, counted: Array) -> None:
        """Add a residual (N, n, m); measured, counted (N, n)."""
        self.count += counted.sum(axis=0)
        self.measured += np.sum(counted * measured**2, axis=0)
        part = residual * counted[..., None]
        self.sum += part.sum(axis=0)
        self.squares += np.sum(part**2, axis=0)
        self.largest = np.maximum(self.largest, np.abs(part).max(axis=0))

    def merge(self, other: _Sizes) -> None:
        self.count, self.measured = self.count + other.count, self.measured + other.measured
        self.sum, self.squares = self.sum + other.sum, self.squares + other.squares
        self.largest = np.maximum(self.largest, other.largest)

    def of(self, k: int) -> ResidualSizes:
        with np.errstate(invalid="ignore", divide="ignore"):
            return ResidualSizes(
                self.count.astype(int),
                self.sum[:, k] / self.count,
                np.sqrt(self.squares[:, k] / self.count),
                np.where(self.count > 0, self.largest[:, k], np.nan),
                np.sqrt(self.squares[:, k] / self.measured),
            )


class _Autocorrelation:
    """Sums Σ_t e_t e_{t-k} for k = 0 … N_LAGS, within pieces."""

    def __init__(self, n: int, m: int):
        self.products = np.zeros((N_LAGS + 1, n, m))
        self.steps = np.zeros((n, m))
        self.tail = np.zeros((0, n, m))

    def add(self, rows: Rows, residual: Array) -> None:
        before = self.tail[:0] if rows.first else self.tail
        joined, start = np.concatenate([before, residual]), len(before)
        for lag in range(min(N_LAGS + 1, len(joined))):
            first = max(start, lag)
            later, earlier = joined[first:], joined[first - lag : len(joined) - lag]
            self.products[lag] += np.sum(later * earlier, axis=0)
            if lag == 1:
                self.steps += np.sum((later - earlier) ** 2, axis=0)
        self.tail = joined[-N_LAGS:]

    def merge(self, other: _Autocorrelation) -> None:
        """Sum with another piece: no product reaches from one into the other."""
        self.products, self.steps = self.products + other.products, self.steps + other.steps

    def durbin_watson(self) -> Array:
        with np.errstate(invalid="ignore", divide="ignore"):
            ratios: Array = self.steps / self.products[0]
            return ratios

    def ljung_box_p(self, count: Array) -> Array:
        from scipy.stats import chi2  # imported where first used: import graphdyn stays light

        lags = np.arange(1, N_LAGS + 1)[:, None, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            r = self.products[1:] / self.products[0]
            q = count[:, None] * (count[:, None] + 2) * np.sum(r**2 / (count[:, None] - lags), axis=0)
        return np.where(count[:, None] > N_LAGS, chi2.sf(q, N_LAGS), np.nan)
