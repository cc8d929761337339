"""Extended Kalman filter for online estimation: state and parameters together, from positions alone.

    state (q, v, x):    q⁺ = q + T v + T²/2 a,   v⁺ = v + T a,   x⁺ = x + drift,     M(q, x) a = τ - h(q, v, x)
    measured:           q, and v with a tachometer

The measured torque drives the model, its noise is that of the state; no differentiation and no filter is needed. a is
the acceleration in the middle of the period. With G_q, G_v = ∂τ/∂q, ∂τ/∂v and the regressor W there,

    da = -M⁻¹ (G_q dq + G_v dv + W dx - dτ)

The filter propagates a square root S of the covariance, P = S Sᵀ, by orthogonal transformations. With F the derivative
of the step, Q = B Bᵀ the process noise, H the measurement, R its variances,

    | R^½      0      |       | T₁₁  T₁₂ |
    | (F S)ᵀHᵀ (F S)ᵀ |  = Q′ | 0    S⁺ᵀ |     gain K = T₁₂ᵀ T₁₁⁻ᵀ
    | BᵀHᵀ     Bᵀ     |

Gautier and Poignet, "Extended Kalman filtering and weighted least squares dynamic identification of robot", Control
Engineering Practice 9(12), 2001; Kaminski, Bryson and Schmidt, IEEE Trans. Automatic Control 16(6), 1971 (the root).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.algebra.least_squares import square_triangle
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.torque_model import TorqueModel, structure
from graphdyn.identification.terms import Drift
from graphdyn.identification.terms.friction import positive
from graphdyn.layout import Array

MIN_MASS_EIGENVALUE_RATIO = 1e-12
"""Smallest eigenvalue of a mass matrix, relative to its largest, with which the state can be predicted."""


class ExtendedKalmanFilter:
    """A running estimate of a torque model, of positions and of velocities.

    period: between two samples [s]
    position_noise, torque_noise, velocity_noise: standard deviations, one for all or (n,); without the last one the
        velocities of the samples are not used, except the first   [rad or m, N m or N, rad/s or m/s]
    start: initial parameters (p,); those of the model, and zero friction, if left out
    spread: standard deviations of these (p,), which determine those of the base parameters
    drift: of the parameters in a second, standard deviation (p,) or one for all; 0: they are constant
    held: whether the torque of a sample acts until the next one; otherwise the mean of both acts between them

    Raises InvalidInput for other numbers, and for friction with memory and drifts.
    """

    def __init__(
        self,
        torque_model: TorqueModel,
        period: float,
        *,
        position_noise: ArrayLike,
        torque_noise: ArrayLike,
        spread: ArrayLike,
        velocity_noise: ArrayLike | None = None,
        start: ArrayLike | None = None,
        drift: ArrayLike = 0.0,
        held: bool = True,
    ) -> None:
        if torque_model.has_memory or any(isinstance(term, Drift) for term in torque_model.terms):
            raise InvalidInput(
                "the filter of Kalman takes the torque as a function of q, v and a; leave friction with memory and "
                "drifts out"
            )
        n, p = torque_model.model.nv, len(torque_model.columns)
        if not (np.isfinite(period) and period > 0):
            raise InvalidInput(f"period is {period!r}; give seconds above zero")
        self._model, self._period, self._held = torque_model, period, held
        self._base = structure(torque_model).base
        self._torque_noise = positive("torque_noise", torque_noise, n)
        seen = [positive("position_noise", position_noise, n)]
        if velocity_noise is not None:
            seen.append(positive("velocity_noise", velocity_noise, n))
        self._measured = np.concatenate(seen)
        x = torque_model.prior() if start is None else as_floats("start", start)
        if x.shape != (p,) or not np.all(np.isfinite(x)):
            raise InvalidInput(f"start has shape {x.shape}, expected ({p},) finite numbers")
        self._x = self._base.values(x)
        self._spread = self._base.matrix * positive("spread", spread, p)
        rates = as_floats("drift", drift)
        if rates.shape not in ((), (p,)) or not np.all(np.isfinite(rates)) or not np.all(rates >= 0):
            raise InvalidInput(f"drift is {np.array2string(rates)}; give one number that is not negative, or {p}")
        changing = np.broadcast_to(rates, (p,)) * np.sqrt(period)
        self._drift = (self._base.matrix * changing)[:, changing > 0]
        self._q, self._v, self._tau = np.zeros((3, n))
        self._root = np.zeros((0, 0))

    def update(self, samples: Samples) -> None:
        """Process one sample or several, one period apart.

        Raises InvalidInput for samples with a pending filter, and for a moving base; EstimationFailed if the
        parameters on the way are physically impossible.
        """
        if samples.row_filter is not None:
            raise InvalidInput("these samples still have to go through a filter; the filter of Kalman needs raw ones")
        if samples.base is not None:
            raise InvalidInput("the base of the samples moves; the filter of Kalman knows a base at rest only")
        for q, v, tau in zip(samples.q, samples.v, samples.tau, strict=True):
            measured = np.concatenate([q, v])[: len(self._measured)]
            if self._root.size:
                self._step(self._tau if self._held else (self._tau + tau) / 2, measured)
            else:
                self._begin(q, v)
            self._tau = tau

    @property
    def values(self) -> Array:
        """Base parameters (r,) of the structure of the torque model."""
        return self._x

    @property
    def covariance(self) -> Array:
        """Covariance of the base parameters (r, r). Raises EstimationFailed before the first sample."""
        if not self._root.size:
            raise EstimationFailed("no sample has arrived yet")
        own = self._root[2 * len(self._q) :]
        return own @ own.T

    @property
    def parameters(self) -> Array:
        """Parameters (p,) of the torque model: those with these base parameters nearest to the model's."""
        return model_prior(self._model).nearest(self._base, self._x)

    def _begin(self, q: Array, v: Array) -> None:
        """Start from the first measured state; a velocity that is not measured is a difference of positions."""
        n, r = len(q), len(self._x)
        position = self._measured[:n]
        velocity = self._measured[n:] if len(self._measured) > n else np.sqrt(2) * position / self._period
        self._q, self._v = np.array(q, dtype=float), np.array(v, dtype=float)
        self._root = np.zeros((2 * n + r, 2 * n + r))
        self._root[: 2 * n, : 2 * n] = np.diag(np.concatenate([position, velocity]))
        self._root[2 * n :, 2 * n :] = square_triangle(self._spread.T).T

    def _step(self, tau: Array, measured: Array) -> None:
        n, r, t = len(self._q), len(self._x), self._period
        a, by_q, by_v, by_x, by_tau = self._acceleration(tau)
        da = np.hstack([by_q, by_v, by_x])
        f = np.eye(2 * n + r)
        # F = ∂(q⁺, v⁺, x⁺)/∂(q, v, x): q⁺ = q + T v + T²/2 a, v⁺ = v + T a
        f[:n, n : 2 * n] += t * np.eye(n)
        f[:n] += t**2 / 2 * da
        f[n : 2 * n] += t * da
        noise = by_tau * self._torque_noise
        # B: what the noise of the torques moves during a period, and the drift of the parameters
        b = np.zeros((2 * n + r, n + self._drift.shape[1]))
        b[:n, :n], b[n : 2 * n, :n], b[2 * n :, n:] = t**2 / 2 * noise, t * noise, self._drift
        root = np.vstack([(f @ self._root).T, b.T])
        k = len(measured)
        # the array of the head; QR leaves T₁₁, T₁₂ and the root of the covariance after the measurement
        before = np.block([[np.diag(self._measured), np.zeros((k, 2 * n + r))], [root[:, :k], root]])
        after = square_triangle(before)
        state = np.concatenate([self._q + t * self._v + t**2 / 2 * a, self._v + t * a, self._x])
        # K (measured - predicted) = T₁₂ᵀ T₁₁⁻ᵀ (measured - predicted)
        state += after[:k, k:].T @ np.linalg.solve(after[:k, :k].T, measured - state[:k])
        if not np.all(np.isfinite(state)):
            raise EstimationFailed("the filter diverged: its state is no number; give a better start or less spread")
        self._q, self._v, self._x = np.split(state, [n, 2 * n])
        self._root = after[k:, k:].T

    def _acceleration(self, tau: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Acceleration in the middle of the period, and its derivatives by q, v, x and τ."""
        n, t = len(self._q), self._period
        a, _ = self._solved(self._q, self._v, tau)
        # half a period on, with the acceleration at its beginning
        q, v = self._q + t / 2 * self._v + t**2 / 8 * a, self._v + t / 2 * a
        a, inverse = self._solved(q, v, tau)
        # central differences over a standard deviation of q and v: friction has a slope where v may change its sign
        steps = np.linalg.norm(self._root[: 2 * n], axis=1)
        # the point itself, then each of the 2 n coordinates a step up, then each a step down
        around = np.vstack([np.zeros((1, 2 * n)), np.diag(steps), -np.diag(steps)])
        points = np.concatenate([q, v]) + around
        here = self._samples(points[:, :n], points[:, n:], np.broadcast_to(a, (4 * n + 1, n)))
        w = self._model.rows(here, self._base.independent)
        torque = w @ self._x + self._model.known_torque(here)
        slopes = ((torque[1 : 2 * n + 1] - torque[2 * n + 1 :]) / (2 * steps[:, None])).T
        return a, -inverse @ slopes[:, :n], -inverse @ slopes[:, n:], -inverse @ w[0], inverse

    def _solved(self, q: Array, v: Array, tau: Array) -> tuple[Array, Array]:
        """a of M a = τ - h, and M⁻¹: the torque at zero acceleration is h, and its columns by a are M."""
        n = len(q)
        a = np.vstack([np.zeros(n), np.eye(n)])
        here = self._samples(np.broadcast_to(q, a.shape), np.broadcast_to(v, a.shape), a)
        torque = self._model.rows(here, self._base.independent) @ self._x + self._model.known_torque(here)
        mass = (torque[1:] - torque[0]).T
        eigenvalues = np.linalg.eigvalsh(mass + mass.T)
        if not eigenvalues[0] > MIN_MASS_EIGENVALUE_RATIO * eigenvalues[-1]:
            raise EstimationFailed(
                "the filter diverged: the mass matrix of its parameters is not positive definite; give a better start "
                "or less spread"
            )
        inverse = np.linalg.inv(mass)
        return inverse @ (tau - torque[0]), inverse

    def _samples(self, q: Array, v: Array, a: Array) -> Samples:
        return Samples(q, v, a, np.zeros(q.shape))
