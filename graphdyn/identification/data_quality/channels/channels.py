"""Data quality of single channels, without a model of the robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.identification.data_quality.fits.thinning import Piece
from graphdyn.identification.statistics.residual_statistics import MIN_MOVING_SPEED
from graphdyn.layout import Array

SAME_SIGNAL_TOLERANCE = 1e-9
"""Distance of a correlation from ±1 below which two channels hold the same signal."""

NOISE_DIFFERENCES = 6
"""Order of the differences that show noise alone: they remove motions a tenth as fast as the sampling."""

MAX_CLOCK_SPREAD, MIN_CLOCK_JOINTS = 0.01, 2
"""Largest difference of the gains of v on the rate of q from a common one, and the number of moving joints that must
have it: on recordings of three arms single joints differ by 0.1 %."""

MIN_CLIPPED_ROWS = 5
"""Consecutive rows at exactly the largest or smallest torque that count as clipped: noise would change them."""


@dataclass(frozen=True, eq=False)
@short_repr
class Channels:
    """Properties of the channels, per joint (n,), over all rows.

    standstill: share of rows with |v| ≤ 0.02 rad/s or m/s (MIN_MOVING_SPEED)
    clipped: share of rows with the torque held at an end of its range; of torques as recorded
    constant_positions, constant_torques: joints; duplicated_…: pairs of joints that have the same signal
    torque_noise: median size of the sixth differences of the torques as recorded, relative to their deviation
    torque_values: number of values that each torque takes
    velocity_gain: of the given v on the rate of q, 1 if v is that rate; NaN for a joint that does not move
    """

    standstill: Array
    clipped: Array
    constant_positions: tuple[int, ...]
    constant_torques: tuple[int, ...]
    duplicated_positions: tuple[tuple[int, int], ...]
    duplicated_torques: tuple[tuple[int, int], ...]
    torque_noise: Array
    torque_values: NDArray[np.intp]
    velocity_gain: Array


def channels(pieces: Sequence[Piece], torques: Sequence[Array]) -> Channels:
    """Channels of pieces. torques: as recorded, before any filter (N_k, n)."""
    q, v = (np.concatenate([getattr(piece.samples, name) for piece in pieces]) for name in ("q", "v"))
    tau = np.concatenate(list(torques))
    return Channels(
        standstill=np.mean(np.abs(v) <= MIN_MOVING_SPEED, axis=0),
        clipped=np.sum([_held(part, tau.min(axis=0), tau.max(axis=0)) for part in torques], axis=0) / len(tau),
        constant_positions=_constant(q),
        constant_torques=_constant(tau),
        duplicated_positions=_duplicated(q),
        duplicated_torques=_duplicated(tau),
        torque_noise=_noise(torques),
        torque_values=np.array([len(np.unique(column)) for column in tau.T]),
        velocity_gain=rate_gain(pieces),
    )


def _noise(torques: Sequence[Array]) -> Array:
    """Median size of the sixth differences, relative to the deviation of the torques (n,); jumps do not count."""
    long = [tau for tau in torques if len(tau) > NOISE_DIFFERENCES]
    n = torques[0].shape[1]
    if not long:
        return np.full(n, np.nan)
    sizes = np.median(np.abs(np.concatenate([np.diff(tau, NOISE_DIFFERENCES, axis=0) for tau in long])), axis=0)
    spread = np.concatenate(long).std(axis=0)
    return np.asarray(sizes / np.where(spread > 0, spread, np.inf))


def _constant(values: Array) -> tuple[int, ...]:
    size = np.abs(values).max(axis=0)
    return tuple(np.flatnonzero(np.ptp(values, axis=0) <= SAME_SIGNAL_TOLERANCE * size).tolist())


def _duplicated(values: Array) -> tuple[tuple[int, int], ...]:
    centered = values - values.mean(axis=0)
    length = np.linalg.norm(centered, axis=0)
    length[list(_constant(values))] = np.inf
    unit = centered / np.where(length > 0, length, np.inf)
    same = np.argwhere(np.triu(np.abs(unit.T @ unit) > 1 - SAME_SIGNAL_TOLERANCE, k=1))
    return tuple((int(i), int(j)) for i, j in same)


def _held(tau: Array, lowest: Array, highest: Array) -> Array:
    """Number of rows in runs of MIN_CLIPPED_ROWS or more at an end of the range (n,)."""
    counts = np.zeros(tau.shape[1])
    for end in (lowest, highest):
        at = np.pad(tau == end, ((1, 1), (0, 0)))
        for j, edges in enumerate(np.diff(at.astype(int), axis=0).T):
            starts, stops = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0)
            lengths = stops - starts
            counts[j] += lengths[lengths >= MIN_CLIPPED_ROWS].sum()
    return counts


def rate_gain(pieces: Sequence[Piece]) -> Array:
    """Gain of v on the rate of q, of each joint (n,); NaN if neither shows a motion: noise is no rate."""
    products, squares, fastest = 0.0, 0.0, np.zeros(pieces[0].samples.q.shape[1])
    for piece in pieces:
        rate = np.gradient(piece.samples.q, piece.period, axis=0)
        fastest = np.maximum(fastest, np.maximum(np.abs(rate), np.abs(piece.samples.v)).max(axis=0))
        products = products + np.sum(rate * piece.samples.v, axis=0)
        squares = squares + np.sum(rate**2, axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where((squares > 0) & (fastest > MIN_MOVING_SPEED), products / squares, np.nan)


def common_rate(gain: Array) -> float:
    """The gain of v on the rate of q that all joints have in common, that of a clock; NaN if they do not agree on one.

    gain: as of rate_gain (n,)
    """
    known = gain[np.isfinite(gain)]
    if len(known) < MIN_CLOCK_JOINTS:
        return float("nan")
    rate = float(np.median(known))
    agreed = rate > 0 and bool(np.all(np.abs(known / rate - 1) < MAX_CLOCK_SPREAD))
    return rate if agreed else float("nan")
