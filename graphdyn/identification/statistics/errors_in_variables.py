"""Equations of the torque at the true motion, which is measured with errors, linearized at its current estimate.

The slopes G = ∂τ/∂(q, v, a) are central differences of W x. They hold for every term of a torque model: friction,
columns of users, and bodies whose parameters are physically inconsistent. The steps are the standard deviations of the
errors of q, v and a, so that sign(v) has a slope where the error may reverse it, and none elsewhere.

The measured motion belongs to the rows of a problem's equations, with the covariance of its errors.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import EstimationFailed
from graphdyn.identification.data.rows import Rows, runs
from graphdyn.identification.data.samples import Samples, joined_samples
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

MOTION_NAMES = ("q", "v", "a")


def torque_slopes(torque_model: TorqueModel, x: Array, motion: Samples, steps: Array) -> Array:
    """G (N, n, 3 n): columns of all q, then v, then a.

    x: parameters (p,); steps: of q, v and a (3, n); a zero step gives a slope of zero
    """
    n = motion.q.shape[1]
    slopes = np.zeros((len(motion), n, 3 * n))
    for d, name in enumerate(MOTION_NAMES):
        for j in np.flatnonzero(steps[d]):
            aside = steps[d, j] * np.eye(n)[j]
            up, down = (
                torque_model.torque(replace(motion, **{name: getattr(motion, name) + sign * aside}), x)
                for sign in (1, -1)
            )
            slopes[..., d * n + j] = (up - down) / (2 * steps[d, j])
    return slopes


MEASURED_ROWS_AT_ONCE = 4096
"""Rows that are computed at once: enough for compiled code to pay off."""

NO_ERRORS = (
    "needs the errors of q, v and a (motion_covariance of the samples), which crosscheck.identify estimates from "
    "recorded positions"
)


@dataclass(frozen=True, eq=False)
class MeasuredRows:
    """Consecutive rows of one run.

    rows: their equations; blocks: the time block of each   (N,)
    motion: their q, v, a
    covariance: of the errors of all q, then v, then a      (3 n, 3 n)
    """

    rows: Rows
    blocks: NDArray[np.int64]
    motion: Samples
    covariance: Array


def measured_motion(problem: Problem) -> Iterator[MeasuredRows]:
    """All equations, window by window.

    Raises EstimationFailed if the errors are not known, for a moving base, and for friction with memory.
    """
    if problem.torque_model.has_memory:
        raise EstimationFailed("knows the errors of a row at a time, and friction with memory takes all rows together")
    motion, covariances, run, position = *_motion(problem), 0
    for parts in _windows(problem.rows()):
        names = ("matrix", "right", "measured", "velocity", "kept")
        matrix, right, measured, velocity, kept = (
            np.concatenate([getattr(part, name) for part in parts]) for name in names
        )
        rows = Rows(matrix, right, measured, velocity, kept)
        blocks = np.concatenate([np.full(len(part), part.block) for part in parts])
        end = position + len(rows)
        yield MeasuredRows(rows, blocks, motion[position:end], covariances[run[position]])
        position = end


def _windows(chunks: Iterable[Rows]) -> Iterator[list[Rows]]:
    """Neighboring chunks of one run, joined up to MEASURED_ROWS_AT_ONCE rows."""
    parts: list[Rows] = []
    for chunk in chunks:
        if parts and (chunk.first or sum(map(len, parts)) >= MEASURED_ROWS_AT_ONCE):
            yield parts
            parts = []
        parts.append(chunk)
    yield parts


def joined(covariance: Array) -> Array:
    """Covariance of all q, then v, then a (3 n, 3 n) from that of q, v, a of each joint (n, 3, 3)."""
    n = len(covariance)
    together = np.zeros((3, n, 3, n))
    for j, own in enumerate(covariance):
        together[:, j, :, j] = own
    return together.reshape(3 * n, 3 * n)


def _motion(problem: Problem) -> tuple[Samples, list[Array], NDArray[np.int64]]:
    """The rows that count among all that the filters keep; the covariance of the errors of every run; each row's
    run.
    """
    parts, covariances, lengths = list[Samples](), list[Array](), list[int]()
    for run in runs([problem.data] if isinstance(problem.data, Samples) else problem.data):
        pieces = list(run.samples)
        if any(piece.base is not None for piece in pieces):
            raise EstimationFailed("the base of the recording moves; errors of the motion know a base at rest only")
        if pieces[0].motion_covariance is None:
            raise EstimationFailed(NO_ERRORS)
        covariances.append(joined(pieces[0].motion_covariance))
        left = joined_samples(pieces, slice(None, None, 1 if run.row_filter is None else run.row_filter.factor))
        parts.append(left)
        lengths.append(len(left))
    of_run = np.repeat(np.arange(len(lengths)), lengths)
    return joined_samples(parts, problem.chosen(np.arange(len(of_run)))), covariances, problem.chosen(of_run)


@dataclass(frozen=True, eq=False)
class Whitened:
    """N rows multiplied by L⁻¹, with S = L Lᵀ the covariance of their residual.

    matrix, right: W(μ) and e                               (N, n, r), (N, n)
    shift: μ - m, the estimated minus the measured motion   (N, 3 n)
    squares: Σ e² over the rows; explained: Σ of the variances G C Gᵀ   (n,)
    """

    matrix: Array
    right: Array
    shift: Array
    squares: Array
    explained: Array


def whitened(problem: Problem, x: Array, part: MeasuredRows, shift: Array, noise: Array) -> Whitened:
    """Whitened rows at base parameters x (r,) and the current estimate of the motion; noise: of the torques (n,)."""
    torque_model, columns = problem.torque_model, problem.base.independent
    measured, kept = part.motion, part.rows.kept[..., None]
    q, v, a = np.split(shift, 3, axis=1)
    estimated = replace(measured, q=measured.q + q, v=measured.v + v, a=measured.a + a)
    steps = np.sqrt(np.diag(part.covariance)).reshape(3, -1)
    standard = model_prior(torque_model).nearest(problem.base, x)
    slopes = torque_slopes(torque_model, standard, estimated, steps) * kept
    # the measured equations are filtered: the difference that the estimated motion makes is added to them
    change = torque_model.rows(estimated, columns) - torque_model.rows(measured, columns)
    known = torque_model.known_torque(estimated) - torque_model.known_torque(measured)
    matrix = (problem.reduced(part.rows) + change) * kept
    # τ - W(μ) x + G (μ - m): the residual at the measured motion, to first order
    e = (part.rows.right - known)[..., None] * kept - matrix @ x[:, None] + slopes @ shift[..., None]
    # S = G C Gᵀ + noise²; the motion that fits best is m + C Gᵀ S⁻¹ e
    gain = part.covariance @ np.swapaxes(slopes, 1, 2)
    propagated = slopes @ gain
    covariance = propagated + np.diag(noise**2)
    factor = np.linalg.cholesky(covariance)
    white = np.linalg.solve(factor, np.concatenate([matrix, e], axis=-1))
    shift = (gain @ np.linalg.solve(covariance, e))[..., 0]
    explained = np.einsum("tjj->j", propagated)
    return Whitened(white[..., :-1], white[..., -1], shift, np.sum(e[..., 0] ** 2, axis=0), explained)
