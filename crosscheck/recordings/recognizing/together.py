"""How columns move together: clocks, rates of other columns, and torques against the model of the robot."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.recordings.checks import MIN_JITTER
from crosscheck.recordings.mapping.units import TIME_UNITS, TURNING_UNITS
from crosscheck.recordings.preparation.derivatives import differentiated
from crosscheck.recordings.preparation.filtering import samples_of
from crosscheck.recordings.recording import Recording
from graphdyn import InvalidInput, RobotModel, inverse_dynamics
from graphdyn.identification import TorqueModel
from graphdyn.identification.terms import Coulomb, Offset, RigidBodies, Viscous
from graphdyn.layout import Array

LIKELY_RATES = (10.0, 20_000.0)
"""Sampling rates of joint controllers and loggers [Hz]: they tell the unit of time where no name does."""

UNEVEN_SHARE = 0.02
"""Share of the steps of a clock that may differ from the median: lost samples."""

WINDOWS, LEAST_CORRELATION = 200, 0.98
"""Intervals over which a column is compared with the change of another; the correlation from which it is its rate."""

UNIT_TOLERANCE = 0.03
"""Relative difference from the ratio of two units up to which it is taken for it."""


def steps_evenly(values: Array) -> bool:
    """Whether a column (N,) increases from row to row by equal steps, but for a few, as clocks do."""
    steps = np.diff(values)
    if len(steps) < 2 or not np.all(np.isfinite(steps)) or not np.all(steps >= 0):
        return False
    period = float(np.median(steps))
    return period > 0 and float(np.mean(np.abs(steps - period) > MIN_JITTER * period)) <= UNEVEN_SHARE


def counts_rows(values: Array) -> bool:
    """Whether a column (N,) increases by one in every row, as a counter of rows does, or a clock in its own period."""
    return bool(np.all(np.diff(values) == 1))


def alike(one: Array, other: Array) -> bool:
    """Whether two clocks (N,) agree in all rows to a part of their period that counts as no jitter."""
    period = float(np.median(np.diff(one)))
    return bool(np.all(np.abs((one - one[0]) - (other - other[0])) <= MIN_JITTER * abs(period)))


def likely_units(period: float) -> list[str]:
    """The units of time with which a period of this number makes a likely rate."""
    least, most = LIKELY_RATES
    return [unit for unit in ("s", "ms", "us", "ns") if least <= 1 / (period * TIME_UNITS[unit]) <= most]


def rates(values: Array) -> Array:
    """Change of column i per row, as a multiple of column j (k, k); 0 where j is not the rate of i.

    values: the columns (N, k). The change of i over each of WINDOWS intervals is compared with the sum of j over it,
    so that noise of neighboring rows cancels.
    """
    edges = np.unique(np.linspace(0, len(values) - 1, WINDOWS + 1, dtype=int))
    change = np.diff(values[edges], axis=0)
    middle = (values[1:] + values[:-1]) / 2
    sums = np.add.reduceat(middle, edges[:-1], axis=0) if len(edges) > 1 else change
    size, total = np.linalg.norm(change, axis=0), np.linalg.norm(sums, axis=0)
    with np.errstate(invalid="ignore", divide="ignore"):
        product = change.T @ sums
        correlation = product / np.outer(size, total)
        gain = product / total**2
    return np.where(np.nan_to_num(np.abs(correlation)) >= LEAST_CORRELATION, gain, 0.0)


LEAST_MOTION = 0.02
"""Range of a joint, as a part of the largest, from which its velocity must be the rate of its position."""


def rate_factor(q: Array, v: Array) -> float | None:
    """Velocities (N, n) as a multiple of the change of positions (N, n) per row; None if they are not their rates."""
    n = q.shape[1]
    links = rates(np.column_stack([np.nan_to_num(q), np.nan_to_num(v)]))[np.arange(n), n + np.arange(n)]
    moving = np.ptp(q, axis=0) > LEAST_MOTION * np.nanmax(np.ptp(q, axis=0))
    if not np.any(moving) or np.any(links[moving] <= 0) or np.ptp(links[moving]) > 0.1 * np.max(links[moving]):
        return None
    return float(1 / np.median(links[moving]))


def unit_of_rate(factor: float, unit_of_position: str) -> str:
    """The unit of a velocity that is `factor` times the rate of positions in this unit, per second; "" for none."""
    position = TURNING_UNITS["q"].get(unit_of_position, 1.0)
    for unit, size in TURNING_UNITS["v"].items():
        if abs(abs(factor) * size / position - 1) <= UNIT_TOLERANCE:
            return unit
    return ""


@dataclass(frozen=True, eq=False)
class TorqueFit:
    """How the torques fit the robot.

    residuals: ‖e_j‖ of the best bodies and drives, as a part of the variation of τ_j        (n,)
    gains: of the measured torque on that of the robot's file, with fitted drives       (n,)
    shares: of the torque that the file explains; the gain means little where it is small     (n,)
    """

    residuals: Array
    gains: Array
    shares: Array

    @property
    def residual(self) -> float:
        """The geometric mean over the joints."""
        return float(np.exp(np.mean(np.log(self.residuals + np.finfo(float).tiny))))

    @property
    def gain(self) -> float | None:
        """The median of the gains of the joints whose torque the file explains; None if there are none."""
        clear = self.gains[self.shares >= CLEAR_SHARE]
        return float(np.median(clear)) if clear.size else None


CLEAR_SHARE = 0.3
"""Share of the torque that the robot's file must explain for a gain to mean something."""

CLEAR_FACTOR = 1.5
"""Ratio of residuals from which one reading is taken rather than another."""

FITTED_ROWS, FIT_CUTOFF = 1500, 6.0
"""Rows of a fit; its low-pass [Hz], at most a tenth of the rate."""


def torque_fit(model: RobotModel, rate: float, q: Array, tau: Array) -> TorqueFit | None:
    """The fit of torques (N, n) to positions at the joints (N, n) [rad or m]; None if it cannot be made."""
    t = np.arange(len(q)) / rate
    try:
        recording = Recording(model.independent_joints, t, q, tau=tau)
        prepared = differentiated(recording, min(FIT_CUTOFF, rate / 10))
        (samples,) = samples_of(prepared)
    except (InvalidInput, ValueError):
        return None
    thin = slice(None, None, max(1, len(samples) // FITTED_ROWS))
    measured = samples.tau if samples.row_filter is None else samples.row_filter(samples.tau)
    samples = type(samples)(samples.q[thin], samples.v[thin], samples.a[thin], measured[thin])
    terms = TorqueModel(model, (RigidBodies(), Viscous(), Coulomb(), Offset()))
    known = inverse_dynamics(model, samples.q, samples.v, samples.a).tau
    return TorqueFit(_residuals(terms.rows(samples), samples.tau), *_gains(samples.v, samples.a, known, samples.tau))


def _residuals(rows: Array, tau: Array) -> Array:
    """Residuals of least squares with joints weighted by the variation of their torques; rows (N, n, p)."""
    size = np.linalg.norm(tau - tau.mean(axis=0), axis=0)
    weights = np.where(size > 0, 1 / np.where(size > 0, size, 1), 0)
    matrix = (rows * weights[:, None]).reshape(-1, rows.shape[-1])
    length = np.linalg.norm(matrix, axis=0)
    matrix = matrix[:, length > 0] / length[length > 0]
    right = (tau * weights).ravel()
    error = right - matrix @ np.linalg.lstsq(matrix, right, rcond=1e-8)[0]
    return np.asarray(np.linalg.norm(error.reshape(tau.shape), axis=0))


def _gains(v: Array, a: Array, known: Array, tau: Array) -> tuple[Array, Array]:
    gains, shares = np.full(tau.shape[1], np.nan), np.zeros(tau.shape[1])
    for j in range(tau.shape[1]):
        columns = np.column_stack([known[:, j], v[:, j], np.sign(v[:, j]), a[:, j], np.ones(len(v))])
        length = np.linalg.norm(columns, axis=0)
        size = np.linalg.norm(tau[:, j])
        if length[0] > 0 and size > 0:
            found = np.linalg.lstsq(columns / np.where(length > 0, length, 1), tau[:, j], rcond=1e-8)[0]
            gains[j], shares[j] = found[0] / length[0], abs(found[0]) / size
    return gains, shares


def sequences(links: Array, n: int, still: Array) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
    """Columns and their rates, n of each at equal distances, from the matrix of `rates` (k, k).

    still: columns that do not change (k,), which are rates of what does not change either
    """
    linked = (links != 0) | np.outer(still, still)
    count, seen = len(links), set[tuple[tuple[int, ...], tuple[int, ...]]]()
    for i, j in zip(*np.nonzero(links), strict=True):
        for stride in range(1, max(1, (count - 1) // max(1, n - 1)) + 1):
            for before in range(n):
                first, other = i - before * stride, j - before * stride
                columns = tuple(int(first) + stride * k for k in range(n))
                slopes = tuple(int(other) + stride * k for k in range(n))
                if min(first, other) < 0 or max(columns[-1], slopes[-1]) >= count or set(columns) & set(slopes):
                    continue
                if (columns, slopes) not in seen and all(linked[a, b] for a, b in zip(columns, slopes, strict=True)):
                    seen.add((columns, slopes))
                    yield columns, slopes


def runs(columns: Sequence[int], n: int) -> list[tuple[int, ...]]:
    """The columns in runs of n, in order; none if their number is no multiple of n."""
    if len(columns) % n:
        return []
    return [tuple(columns[k : k + n]) for k in range(0, len(columns), n)]
