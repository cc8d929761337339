"""Gain of the measured torque: its factor to that of the model as given."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.least_squares import orthonormal_basis
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.fits.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms.term import CarriesBodies
from graphdyn.layout import Array

JACKKNIFE_BLOCKS = 20
"""Number of time blocks, each of which is left out once for the standard deviation (jackknife)."""


MAX_CAD_RESIDUAL, MIN_MEASURED_RATIO = 2e-3, 10.0
"""Residual of CAD with fitted drives, relative to the torque, up to which a torque is its output, and the smallest
ratio to it of those of the other joints: measured torques leave 2 % or more."""

MAX_FIT_RESIDUAL, MIN_FIT_RATIO, MAX_NOISE_RATIO = 0.01, 4.0, 0.1
"""The same of the fit, which is closer to any torque, for a torque that also has less than this part of the noise of
the others: measured torques have ratios of residuals up to 3."""

TRIED_UNITS = np.concatenate([[0.0], np.geomspace(1e-3, 1e3, 121)])
"""Units of the torques in N m or N that are tried, 12 % apart."""

NEGLIGIBLE_TORQUE_SHARE = 1e-6
"""Predicted torque, relative to the measured one, below which it is rounding."""


@dataclass(frozen=True, eq=False)
@short_repr
class Gains:
    """Gains per joint of τ = gain · τ_model + drives, with the drives fitted along (n,).

    gain: of measured on predicted torque, 1 for SI units at the joints and a right model; NaN if the model predicts no
        torque
    deviation: standard deviation of the gain; NaN likewise
    share: ‖gain · τ_model‖ / ‖τ‖; if it is small, the drives dominate the torque, and the gain means little
    without_gain: ‖e_j‖ / ‖τ_j‖ of the model with drives, gain 1
    """

    gain: Array
    deviation: Array
    share: Array
    without_gain: Array


def gains(torque_model: TorqueModel, samples: Samples, fit: BoundedFit, further: Array | None = None) -> Gains:
    """Gains of these samples. fit: of the same samples; further: columns that belong to no body (N, n, c)."""
    prior = torque_model.prior()
    model = fit.matrix @ prior + fit.known
    drives = drive_columns(torque_model)
    n = samples.tau.shape[1]
    gain, deviation, share, without = (np.full(n, np.nan) for _ in range(4))
    for j in range(n):
        kept = fit.kept[:, j]
        own = np.column_stack([fit.matrix[kept, j][:, drives], samples.a[kept, j]])
        if further is not None:
            own = np.column_stack([own, further[kept, j]])
        own = own[:, np.linalg.norm(own, axis=0) > 0]  # a tiny column is not zero, but its length is
        tau, predicted = samples.tau[kept, j], model[kept, j]
        size = np.linalg.norm(tau)
        if size == 0 or np.linalg.norm(predicted) <= NEGLIGIBLE_TORQUE_SHARE * size:
            continue
        without[j] = _misfit(own, tau - predicted) / size
        columns = np.column_stack([predicted, own])
        gain[j], deviation[j] = _first_with_deviation(columns, tau)
        share[j] = abs(gain[j]) * np.linalg.norm(predicted) / size
    return Gains(gain, deviation, share, without)


def misfits_in_units(torque_model: TorqueModel, samples: Samples, fit: BoundedFit) -> Array:
    """Σ_j log ‖e_j‖ / ‖τ_j‖ of CAD with fitted drives, in each of TRIED_UNITS. fit: of the same samples"""
    model, drives = fit.matrix @ torque_model.prior() + fit.known, drive_columns(torque_model)
    total = np.zeros(len(TRIED_UNITS))
    for j in range(samples.tau.shape[1]):
        kept = fit.kept[:, j]
        size = np.linalg.norm(samples.tau[kept, j])
        if size > 0:
            basis = orthonormal_basis(
                np.column_stack([fit.matrix[kept, j][:, drives], samples.a[kept, j]]), RANK_TOLERANCE
            )
            sides = np.column_stack([samples.tau[kept, j], model[kept, j]])
            tau, predicted = (sides - basis @ (basis.T @ sides)).T
            errors = np.linalg.norm(tau[:, None] - predicted[:, None] * TRIED_UNITS, axis=0)
            total += np.log(np.maximum(errors / size, MIN_RESIDUAL))
    return total


def modeled_torques(found: Gains, errors: Array, noise: Array) -> tuple[int, ...]:
    """Joints whose torque is the output of a model, while others were measured.

    found: gains; errors: ‖e_j‖ / ‖τ_j‖ of the fit within bounds (n,); noise: as Channels.torque_noise (n,)
    """
    if len(errors) < 2:
        return ()
    cad, fit, usual = (
        np.array([np.median(np.delete(x, j)) for j in range(len(x))]) for x in (found.without_gain, errors, noise)
    )
    of_cad = (found.without_gain <= MAX_CAD_RESIDUAL) & (cad > MIN_MEASURED_RATIO * found.without_gain)
    of_fit = (errors <= MAX_FIT_RESIDUAL) & (fit > MIN_FIT_RATIO * errors) & (noise < MAX_NOISE_RATIO * usual)
    return tuple(np.flatnonzero(of_cad | of_fit).tolist())


def drive_columns(torque_model: TorqueModel) -> NDArray[np.intp]:
    """Columns that belong to no body."""
    of_drives = np.zeros(len(torque_model.columns), dtype=bool)
    for term, columns in torque_model.parts:
        of_drives[columns] = not isinstance(term, CarriesBodies)
    return np.flatnonzero(of_drives)


def _first_with_deviation(columns: Array, right: Array) -> tuple[float, float]:
    """The first coefficient of the fit, and its standard deviation by leaving out one block after the other."""
    length = np.linalg.norm(columns, axis=0)
    unit = columns / length
    edges = np.linspace(0, len(right), JACKKNIFE_BLOCKS + 1).astype(int)
    blocks = [slice(a, b) for a, b in pairwise(edges)]
    grams = np.array([unit[rows].T @ unit[rows] for rows in blocks])
    sides = np.array([unit[rows].T @ right[rows] for rows in blocks])
    whole = np.linalg.lstsq(grams.sum(axis=0), sides.sum(axis=0), rcond=RANK_TOLERANCE)[0][0]
    parts = [
        np.linalg.lstsq(grams.sum(axis=0) - gram, sides.sum(axis=0) - side, rcond=RANK_TOLERANCE)[0][0]
        for gram, side in zip(grams, sides, strict=True)
    ]
    variance = (JACKKNIFE_BLOCKS - 1) / JACKKNIFE_BLOCKS * np.sum((np.array(parts) - np.mean(parts)) ** 2)
    return float(whole / length[0]), float(np.sqrt(variance) / length[0])


def _misfit(columns: Array, right: Array) -> float:
    """Part of ‖right‖ that the columns do not explain."""
    length = np.linalg.norm(columns, axis=0)
    coefficients = np.linalg.lstsq(columns / length, right, rcond=RANK_TOLERANCE)[0]
    return float(np.linalg.norm(right - columns / length @ coefficients))
