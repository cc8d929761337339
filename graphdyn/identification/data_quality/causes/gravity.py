"""Gravity that explains the torques best: its direction shows how the robot is mounted.

The regressor of rigid bodies is linear in gravity, W(g) = W_0 + Σ_k g_k W_k. The Gram matrices of its four parts
therefore give the criterion Σ_j log ‖e_j‖ of the fit without bounds for any g in a millisecond.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE, Indices
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.channels.measured_torque import drive_columns
from graphdyn.identification.data_quality.fits.bounded_fit import MIN_RESIDUAL, BoundedFit
from graphdyn.identification.data_quality.fits.free_fit import gram_misfit, grams
from graphdyn.identification.problem.torque_model import TorqueModel, structure
from graphdyn.layout import Array
from graphdyn.model.robot_model import STANDARD_GRAVITY

TRIED_DIRECTIONS = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z])
"""Directions of gravity to begin with, 45° to 55° apart."""

GENERIC_GRAVITY = np.array([3.0, -5.0, 7.0])
"""A gravity along no axis of a robot: under it all base parameters show that some gravity shows [m/s²]."""

GRAVITY_FACTORS = list(combinations_with_replacement(range(4), 2))
"""Pairs of 1, g_x, g_y, g_z whose products multiply the Gram matrices."""

WEIGHTED_FITS = 3
"""Number of fits of CAD, each weighted by the residuals of the one before."""

GRAVITY_TOLERANCE = 1e-3
"""Precision of the search, relative to the size of gravity."""


class GravityFit:
    """The criterion of a recording, as a function of gravity in world axes (3,) [m/s²]."""

    def __init__(self, torque_model: TorqueModel, samples: Samples, kept: NDArray[np.bool_]):
        model = torque_model.model
        self.given = np.asarray(model.gravity, dtype=float)
        self._size = float(np.linalg.norm(self.given)) or float(np.linalg.norm(STANDARD_GRAVITY))
        parts, generic = [], TorqueModel(model.with_gravity(GENERIC_GRAVITY), torque_model.terms, torque_model.known)
        columns = structure(generic).base.independent
        for vector in np.concatenate([np.zeros((1, 3)), self._size * np.eye(3)]):
            there = TorqueModel(model.with_gravity(vector), torque_model.terms, torque_model.known)
            known = there.known_torque(samples)
            parts.append(np.concatenate([there.rows(samples, columns), -known[..., None]], axis=-1))
        parts[1:] = [part - parts[0] for part in parts[1:]]
        parts[0][..., -1] += samples.tau
        _hold_drives(parts, torque_model, samples, columns)
        n, width = samples.tau.shape[1], parts[0].shape[-1]
        stacked = np.concatenate(parts, axis=-1)
        whole = grams(stacked[..., :-1], stacked[..., -1], samples.tau, kept).reshape(n, 4, width, 4, width)
        halves = [whole[:, a, :, b] * (0.5 if a == b else 1.0) for a, b in GRAVITY_FACTORS]
        self._grams = np.stack([half + np.swapaxes(half, 1, 2) for half in halves])

    def misfit(self, gravity: Array) -> float:
        """Σ_j log(‖e_j‖ / ‖τ_j‖) of the fit without bounds."""
        one = np.append(1.0, gravity / self._size)
        return gram_misfit(np.tensordot([one[a] * one[b] for a, b in GRAVITY_FACTORS], self._grams, 1))

    def best(self) -> tuple[Array, float]:
        """Gravity with the smallest criterion, and this criterion."""
        from scipy.optimize import minimize

        unit = TRIED_DIRECTIONS / np.linalg.norm(TRIED_DIRECTIONS, axis=1)[:, None]
        starts = sorted(unit.tolist(), key=lambda direction: self.misfit(self._size * np.array(direction)))
        found = [
            minimize(
                lambda x: self.misfit(self._size * x),
                start,
                method="Nelder-Mead",
                options={"xatol": GRAVITY_TOLERANCE, "fatol": GRAVITY_TOLERANCE},
            )
            for start in (self.given / self._size, starts[0])
        ]
        best = min(found, key=lambda result: float(result.fun))
        return np.asarray(self._size * best.x), float(best.fun)


def _hold_drives(parts: list[Array], torque_model: TorqueModel, samples: Samples, columns: Indices) -> None:
    """Hold the columns of drives as they are: friction that grows with the load is not linear in gravity."""
    held = np.flatnonzero(np.isin(columns, drive_columns(torque_model)))
    parts[0][..., held] = torque_model.rows(samples, columns[held])
    for part in parts[1:]:
        part[..., held] = 0.0


def gravity_of_cad(torque_model: TorqueModel, samples: Samples, fit: BoundedFit) -> Array:
    """Gravity with which CAD and fitted drives explain the torques best (3,) [m/s²]. fit: of the same samples

    The torque of CAD is linear in gravity. The joints are weighted by their residuals.
    """
    x, n = torque_model.prior(), samples.tau.shape[1]
    by_gravity = []
    for vector in np.concatenate([np.zeros((1, 3)), np.eye(3)]):
        there = TorqueModel(torque_model.model.with_gravity(vector), torque_model.terms, torque_model.known)
        by_gravity.append(there.torque(samples, x))
    rest, slopes = by_gravity[0], np.stack([torque - by_gravity[0] for torque in by_gravity[1:]], axis=-1)
    rotors = samples.a[..., None] * np.eye(n)
    columns = np.concatenate([slopes, fit.matrix[..., drive_columns(torque_model)], rotors], axis=-1)
    sizes = np.linalg.norm(np.where(fit.kept, samples.tau, 0.0), axis=0)
    noise, solution = np.where(sizes > 0, sizes, 1.0), np.zeros(columns.shape[-1])
    for _ in range(WEIGHTED_FITS):
        weight = fit.kept / noise
        weighted, right = (columns * weight[..., None]).reshape(-1, columns.shape[-1]), (samples.tau - rest) * weight
        length = np.linalg.norm(weighted, axis=0)
        length[length == 0] = np.inf
        solution = np.linalg.lstsq(weighted / length, right.ravel(), rcond=RANK_TOLERANCE)[0] / length
        error = np.linalg.norm(np.where(fit.kept, columns @ solution + rest - samples.tau, 0.0), axis=0)
        noise = np.maximum(error, MIN_RESIDUAL * np.where(sizes > 0, sizes, 1.0))
    return np.asarray(solution[:3])
