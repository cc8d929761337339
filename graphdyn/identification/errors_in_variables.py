"""Equations of the torque at the true motion, which is measured with errors, linearised at what is known of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from graphdyn.identification.measured_motion import Measured
from graphdyn.identification.prior import model_prior
from graphdyn.identification.problem import Problem
from graphdyn.identification.torque_slopes import torque_slopes
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Whitened:
    """Of N rows, multiplied with L⁻¹, S = L Lᵀ the covariance of their residual.

    matrix, right: W(μ) and e                               (N, n, r), (N, n)
    shift: μ - m, the estimated motion less the measured one   (N, 3 n)
    squares: Σ e² over the rows; explained: Σ of the variances G C Gᵀ   (n,)
    """

    matrix: Array
    right: Array
    shift: Array
    squares: Array
    explained: Array


def whitened(problem: Problem, x: Array, part: Measured, shift: Array, noise: Array) -> Whitened:
    """At base parameters x (r,) and the motion estimated so far; noise: of the torques (n,)."""
    torque_model, columns = problem.torque_model, problem.base.independent
    measured, kept = part.motion, part.rows.kept[..., None]
    q, v, a = np.split(shift, 3, axis=1)
    estimated = replace(measured, q=measured.q + q, v=measured.v + v, a=measured.a + a)
    steps = np.sqrt(np.diag(part.covariance)).reshape(3, -1)
    standard = model_prior(torque_model).nearest(problem.base, x)
    slopes = torque_slopes(torque_model, standard, estimated, steps) * kept
    change = torque_model.rows(estimated, columns) - torque_model.rows(measured, columns)
    known = torque_model.known_torque(estimated) - torque_model.known_torque(measured)
    matrix = (problem.reduced(part.rows) + change) * kept
    e = (part.rows.right - known)[..., None] * kept - matrix @ x[:, None] + slopes @ shift[..., None]
    gain = part.covariance @ np.swapaxes(slopes, 1, 2)
    propagated = slopes @ gain
    covariance = propagated + np.diag(noise**2)
    factor = np.linalg.cholesky(covariance)
    white = np.linalg.solve(factor, np.concatenate([matrix, e], axis=-1))
    shift = (gain @ np.linalg.solve(covariance, e))[..., 0]
    explained = np.einsum("tjj->j", propagated)
    return Whitened(white[..., :-1], white[..., -1], shift, np.sum(e[..., 0] ** 2, axis=0), explained)
