"""Newton's method for least squares over physically consistent bodies with an entropic prior, several problems at once.

    f(u) = uᵀH u - 2 gᵀu + strength · (Σ_i tr S_i - log det S_i) + κ ‖y‖² - 2 μ Σ log y_nonnegative

u = (s, y): s are the ten coordinates of every body's S_i, which is the unit matrix for the prior
(graphdyn.identification.consistent.coordinates), y the further columns. The log det keeps every body physically
consistent, and -log y friction and rotors positive: f is smooth and convex, so that a few Newton steps reach its
minimum without a cone solver.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.consistent.coordinates import IDENTITY_COORDINATES, SYMMETRIC_BASIS
from graphdyn.layout import BODY_PARAMETERS, Array

DRIVE_WEIGHT = 10.0
"""κ: drives are expected to make a third of the measured torque, in units of which y is. What a recording shows has
thousands of times this weight. What one fold alone shows, such as the only reversal of a joint, stays finite in the fit
to the others."""

BARRIER_WEIGHT = 1e-2
"""μ: a parameter that would be zero stays a tenth of its standard deviation above it, which no prediction shows."""

MIN_DECREMENT = 1e-2
"""Newton decrement at which the steps end: f is then exact to a hundredth of the variance of one residual."""

MAX_BODY_STEPS = 50

MAX_HALVINGS = 40

BOUNDARY_SHARE = 0.9
"""Largest part of the way to the boundary of a positive parameter that one step takes."""

SUFFICIENT_DECREASE = 0.1
"""Part of the decrease that the slope predicts which a step must reach (Armijo)."""


@dataclass(frozen=True, eq=False)
class BodyNewton:
    """The prior and the bounds, the same for all problems.

    n_bodies: unknown bodies; nonnegative: which further columns cannot be negative (k,); strength: of the prior
    """

    n_bodies: int
    nonnegative: NDArray[np.bool_]
    strength: float

    @property
    def width(self) -> int:
        """Number of coordinates of the bodies."""
        return BODY_PARAMETERS * self.n_bodies

    def start(self, share: float) -> Array:
        """u of the prior, with this value of all parameters that cannot be negative (p,)."""
        return np.concatenate([np.tile(IDENTITY_COORDINATES, self.n_bodies), np.where(self.nonnegative, share, 0.0)])

    def minimum(self, h: Array, g: Array, start: Array) -> Array:
        """The minima (B, p) for H (B, p, p), g (B, p) from starts inside the bounds (B, p)."""
        u = start.copy()
        left = np.arange(len(u))  # problems that have not converged
        for _ in range(MAX_BODY_STEPS):
            step, decrement = self._step(h[left], g[left], u[left])
            going = decrement > MIN_DECREMENT
            left, step, decrement = left[going], step[going], decrement[going]
            if not len(left):
                break
            u[left] = self._moved(h[left], g[left], u[left], step, decrement)
        return u

    def _step(self, h: Array, g: Array, u: Array) -> tuple[Array, Array]:
        """Newton steps (B, p) and their decrements (B,)."""
        w, held = self.width, self.width + np.flatnonzero(self.nonnegative)
        slope = 2 * (np.einsum("bij,bj->bi", h, u) - g)
        curved = 2 * h
        slope[:, w:] += 2 * DRIVE_WEIGHT * u[:, w:]
        diagonal = np.arange(w, u.shape[1])
        curved[:, diagonal, diagonal] += 2 * DRIVE_WEIGHT
        inverse = np.linalg.inv(self._bodies(u))
        unit = np.tile(IDENTITY_COORDINATES, self.n_bodies)
        slope[:, :w] += self.strength * (unit - np.einsum("ijk,bnij->bnk", SYMMETRIC_BASIS, inverse).reshape(len(u), w))
        turned = np.einsum("bnij,jak->bniak", inverse, SYMMETRIC_BASIS)
        blocks = self.strength * np.einsum("bniak,bnail->bnkl", turned, turned, optimize=True)
        for i in range(self.n_bodies):
            own = slice(BODY_PARAMETERS * i, BODY_PARAMETERS * (i + 1))
            curved[:, own, own] += blocks[:, i]
        slope[:, held] -= 2 * BARRIER_WEIGHT / u[:, held]
        curved[:, held, held] += 2 * BARRIER_WEIGHT / u[:, held] ** 2
        scale = 1 / np.sqrt(np.einsum("bii->bi", curved))
        curved *= scale[:, :, None]
        curved *= scale[:, None, :]
        step = -scale * np.linalg.solve(curved, (scale * slope)[..., None])[..., 0]
        return step, -np.sum(slope * step, axis=1)

    def _moved(self, h: Array, g: Array, u: Array, step: Array, decrement: Array) -> Array:
        """The points after steps that are halved until they stay inside the bounds and lower f."""
        held = self.width + np.flatnonzero(self.nonnegative)
        falling = np.where(step[:, held] < 0, -step[:, held] / u[:, held], 0.0)
        part = np.minimum(1.0, BOUNDARY_SHARE / np.maximum(falling.max(axis=1, initial=0.0), BOUNDARY_SHARE))
        before = self._value(h, g, u)
        for _ in range(MAX_HALVINGS):
            after = self._value(h, g, u + part[:, None] * step)
            slack = np.finfo(float).eps * np.abs(before)
            poor = ~(after <= before - SUFFICIENT_DECREASE * part * decrement + slack)
            if not poor.any():
                break
            part[poor] /= 2
        return np.asarray(u + np.where(poor, 0.0, part)[:, None] * step)

    def _value(self, h: Array, g: Array, u: Array) -> Array:
        """f (B,), infinite outside the bounds."""
        w, held = self.width, self.width + np.flatnonzero(self.nonnegative)
        value = np.einsum("bi,bij,bj->b", u, h, u, optimize=True) - 2 * np.sum(g * u, axis=1)
        values = np.linalg.eigvalsh(self._bodies(u))
        inside = np.all(values > 0, axis=(1, 2)) & np.all(u[:, held] > 0, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            value += self.strength * np.sum(values - np.log(values), axis=(1, 2))
            value += DRIVE_WEIGHT * np.sum(u[:, w:] ** 2, axis=1)
            value -= 2 * BARRIER_WEIGHT * np.sum(np.log(u[:, held]), axis=1)
        return np.where(inside, value, np.inf)

    def _bodies(self, u: Array) -> Array:
        """S of every body (B, n_bodies, 4, 4)."""
        s = u[:, : self.width].reshape(len(u), self.n_bodies, BODY_PARAMETERS)
        return np.asarray(np.einsum("ijk,bnk->bnij", SYMMETRIC_BASIS, s))
