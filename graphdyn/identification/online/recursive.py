"""Recursive least squares for online estimation: the estimate after every sample, with optional forgetting.

    minimize Σ_t λ^(T - t) Σ_g (W_tg x - τ_tg)² / σ_g²

A triangular factor of the equations so far is multiplied by λ^½ and updated with the new rows by QR. This is
recursive least squares in its square-root form: the same numbers as weighted least squares of all samples at once, and
no covariance that loses its symmetry. Golub and Van Loan, Matrix Computations, section 6.5; Haykin, Adaptive Filter
Theory, chapter on square-root adaptive filters.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.compressed import Solution, solve_triangle
from graphdyn.identification.algebra.least_squares import square_triangle
from graphdyn.identification.data.samples import Samples, TorqueFreeSamples
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.torque_model import TorqueModel, structure
from graphdyn.identification.terms.friction import positive
from graphdyn.layout import Array


class RecursiveLeastSquares:
    """A running estimate of a torque model.

    noise: σ_g of the torque of each joint, one for all or (n,)   [N m or N]
    forgetting: λ per sample, above 0 and up to 1; about 1 / (1 - λ) samples count
    min_speed: equations of joint j with |v_j| below it are left out, one for all or (n,)   [rad/s or m/s]

    Raises InvalidInput for other numbers, and for friction with memory.
    """

    def __init__(
        self, torque_model: TorqueModel, noise: ArrayLike, *, forgetting: float = 1.0, min_speed: ArrayLike = 0.0
    ) -> None:
        if torque_model.has_memory:
            raise InvalidInput(
                "friction with memory needs whole runs, not sample by sample; leave it out, or use a Problem"
            )
        if not 0 < forgetting <= 1:
            raise InvalidInput(f"forgetting is {forgetting!r}; give a factor above 0 and up to 1, where nothing is")
        deviations = positive("noise", noise, torque_model.model.nv)
        self._model, self._noise, self._forgetting, self._speed = torque_model, deviations, forgetting, min_speed
        self._base = structure(torque_model).base
        self._factor = np.zeros((self._base.rank + 1, self._base.rank + 1))

    def update(self, samples: Samples) -> None:
        """Process samples in the order of time. Raises InvalidInput for samples with a pending filter."""
        if samples.row_filter is not None:
            raise InvalidInput("these samples still have to go through a filter; give filtered ones, or a Problem")
        w = self._model.rows(TorqueFreeSamples(samples), self._base.independent)
        right = np.asarray(samples.tau, dtype=float) - self._model.known_torque(samples)
        rows = np.concatenate([w, right[..., None]], axis=-1) / self._noise[:, None]
        age = np.arange(len(samples))[::-1, None, None]
        kept = np.abs(np.asarray(samples.v)) >= np.asarray(self._speed)
        new = (rows * self._forgetting ** (age / 2))[kept]
        old = self._factor * self._forgetting ** (len(samples) / 2)
        self._factor = square_triangle(np.concatenate([old, new]))

    @property
    def solution(self) -> Solution:
        """Base parameters x (r,) and their covariance. Raises EstimationFailed before the samples determine them."""
        return solve_triangle(self._factor[:, :-1], self._factor[:, -1])

    @property
    def parameters(self) -> Array:
        """Parameters (p,) of the torque model: those with these base parameters nearest to the model's."""
        return model_prior(self._model).nearest(self._base, self.solution.x)
