"""Ridge regression toward a prior, its strength by cross-validation over time blocks.

    x = argmin Σ_g ‖W_g x - τ_g‖² / σ_g² + λ Σ_k ((x_k - mean_k) / scale_k)²

in all standard parameters: those that the data do not determine stay at the prior. Parameters without a scale
(friction, offset) are not drawn. Hoerl and Kennard, Technometrics 12(1), 1970; blocks of time instead of single
samples, because neighboring samples are correlated: Roberts et al., Ecography 40(8), 2017.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from graphdyn.display import short_repr
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.compressed import EPS, CompressedEquations, joint_noise
from graphdyn.identification.estimation.cross_validation import Trained, cross_validation
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.problem.prior import Prior, model_prior
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array

RIDGE_STRENGTHS = tuple(10.0**k for k in range(-8, 9))
"""Strengths λ that cross-validation tries; at λ = 1 the scale of the prior is its standard deviation."""


@dataclass(frozen=True, eq=False)
@short_repr
class Ridge:
    """Ridge regression toward a prior.

    prior: that of the model if left out; strength: λ, chosen from `strengths` if left out

    The settings of the estimate are the strength, and the root mean square error of validation in units of the noise.
    """

    prior: Prior | None = None
    strength: float | None = None
    strengths: tuple[float, ...] = RIDGE_STRENGTHS
    name: str = "ridge"
    reference: str = "Hoerl and Kennard, Technometrics 12(1), 1970"
    assumptions: str = "as WLS, and a prior that is right up to its scale; the estimate is biased towards it"
    needs: str = "q, v, a, actuator torques, and masses, centers and tensors from CAD"
    takes_expected: ClassVar[bool] = True

    def estimate(self, problem: Problem) -> Estimate:
        prior = model_prior(problem.torque_model) if self.prior is None else self.prior
        noise = joint_noise(problem.equations)
        settings: dict[str, float] = {}
        remarks: tuple[str, ...] = ()
        strength, solutions = self.strength, 1

        def trained(equations: CompressedEquations) -> Trained:
            return RidgePath.of(*equations.informed(noise), problem.base.matrix, prior).at

        if strength is None:
            choice = cross_validation(problem, noise, self.strengths, trained)
            strength, remarks, solutions = choice.best, choice.remarks, 1 + len(problem.folds)
            error = choice.errors.sum(axis=0).min() / problem.equations.counts.sum()
            settings["validation error"] = float(np.sqrt(error))
        path = RidgePath.of(*problem.equations.informed(noise), problem.base.matrix, prior)
        spread = problem.base.matrix @ path.response(strength)
        settings["strength"] = strength
        return Estimate(path.at(strength), spread @ spread.T, None, noise, solutions, settings, remarks)


@dataclass(frozen=True, eq=False)
class RidgePath:
    """The solutions of ‖R x - z‖² + λ ‖(x - mean) / scale‖² for every λ, after one decomposition.

    With f the free and d the drawn parameters, in units of the scale: R_f f + R_d d ≈ c = z - R mean. P projects on
    the complement of the range of R_f, P R_d = U Σ Vᵀ, so that d = V (Σ² + λ)⁻¹ Σ Uᵀ c and f = R_f⁺ (c - R_d d).
    """

    prior: Prior
    free_inverse: Array
    drawn_columns: Array
    u: Array
    sigma: Array
    v_t: Array
    right: Array

    @classmethod
    def of(cls, r_base: Array, z: Array, base_matrix: Array, prior: Prior) -> RidgePath:
        """Solutions of ‖R_base B x - z‖, B the matrix of the base parameters."""
        r = r_base @ base_matrix
        drawn = np.isfinite(prior.scale)
        r_f, r_d = r[:, ~drawn], r[:, drawn] * prior.scale[drawn]
        length = np.linalg.norm(r_f, axis=0)
        length[length == 0] = 1.0
        basis, s, v_t = np.linalg.svd(r_f / length, full_matrices=False)
        rank = int(np.count_nonzero(s > RANK_TOLERANCE * s.max(initial=0.0)))
        basis, free_inverse = basis[:, :rank], (v_t[:rank].T / s[:rank]) @ basis[:, :rank].T / length[:, None]
        u, sigma, v_t = np.linalg.svd(r_d - basis @ (basis.T @ r_d), full_matrices=False)
        seen = sigma > len(prior.mean) * EPS * sigma.max(initial=0.0)
        seen[len(base_matrix) - rank :] = False  # beyond the rank of B all is rounding
        return cls(prior, free_inverse, r_d, u[:, seen], sigma[seen], v_t[seen], z - r @ prior.mean)

    def at(self, strength: float) -> Array:
        """Solution x (p,) for this λ."""
        return self.prior.mean + self._step(strength, self.right)

    def response(self, strength: float) -> Array:
        """Response dx / dc (p, rows): the solution is linear in c."""
        return self._step(strength, np.eye(len(self.right)))

    def _step(self, strength: float, right: Array) -> Array:
        drawn = np.isfinite(self.prior.scale)
        d = self.v_t.T @ ((self.sigma / (self.sigma**2 + strength) * (self.u.T @ right).T).T)
        step = np.zeros((len(drawn), *right.shape[1:]))
        step[drawn] = (self.prior.scale[drawn] * d.T).T
        step[~drawn] = self.free_inverse @ (right - self.drawn_columns @ d)
        return step
