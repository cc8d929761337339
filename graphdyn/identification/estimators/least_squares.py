"""Linear least squares on base parameters: ordinary, weighted, essential and total.

Ordinary least squares (IDIM-OLS):

    x = argmin Σ_g ‖W_g x - τ_g‖²

All joints have the same weight, in N m. The standard deviations allow each joint its own noise:
cov x = C (Σ_g σ_g² W_gᵀW_g) C,  C = (WᵀW)⁻¹,  σ_g² = ‖W_g x - τ_g‖² / (N_g - tr(W_g C W_gᵀ)).

Weighted least squares (IDIM-WLS): every joint is weighted by its own noise.

    x = argmin Σ_g ‖W_g x - τ_g‖² / σ_g²,     cov x = (Σ_g W_gᵀW_g / σ_g²)⁻¹

σ_g comes from the residual of joint g alone, fitted by the parameters that act on it.

Essential parameters: weighted least squares on the base parameters that the data determine well. The parameter with the
largest relative standard deviation %σ = 100 σ / |x| is set to zero, and the rest is estimated again. This ends when the
largest %σ is below `ratio` times the smallest, or when one more removal would raise the weighted residual by more than
`increase` of itself. Khalil and Dombre, Modeling, Identification and Control of Robots, 2002, section 12.4; Pham and
Gautier, "Essential parameters of robots", IEEE CDC 1991.

Total least squares: errors in the regressor as well as in the torque. It serves only for comparison.

    minimize ‖[E | e]‖²   subject to   (W D⁻¹ + E) y = τ + e,   x = D⁻¹ y

with rows weighted by the noise of their joint and D the lengths of the columns: (x, -1) is the right singular vector of
the smallest singular value of [W D⁻¹ | τ / ‖τ‖]. It is right if the errors of all entries are independent and equally
large relative to their column. Those of W are neither: gravity has hardly any and inertia all, and the columns of one
sample share the errors of the same q, v and a. Without D the result depends on the units.

Golub and Van Loan, "An analysis of the total least squares problem", SIAM J. Numerical Analysis 17(6), 1980.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.compressed import (
    EPS,
    CompressedEquations,
    Solution,
    joint_noise,
    leverages,
    residual_deviations,
    solve,
    weighted_solution,
)
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.problem import Problem
from graphdyn.identification.statistics.correlation import jackknife_covariance
from graphdyn.layout import Array


@dataclass(frozen=True)
class OrdinaryLeastSquares:
    """Ordinary least squares."""

    name: str = "OLS"
    reference: str = "Atkeson, An and Hollerbach, Int. J. of Robotics Research 5(3), 1986; Gautier, 1991"
    assumptions: str = "white noise of the same size on all torques; q, v, a without error"
    needs: str = "q, v, a and actuator torques"

    def estimate(self, problem: Problem) -> Estimate:
        solution, covariance, noise = ordinary_solution(problem.equations)
        blocks = jackknife_covariance(problem.blocks, solution.x, np.ones(problem.n_joints))
        return base_estimate(problem, solution.x, covariance, noise, block_covariance=blocks)


def ordinary_solution(equations: CompressedEquations) -> tuple[Solution, Array, Array]:
    """The solution, its covariance (b, b), and the noise of each group (g,)."""
    ones = np.ones(equations.n_groups)
    solution = solve(equations, ones)
    used = leverages(equations, ones, solution.inverse)
    noise = residual_deviations(equations, equations.residual_squares(solution.x), used)
    noisy = noise[:, None, None] * equations.factors[..., :-1]
    spread = noisy.reshape(-1, equations.n_columns) @ solution.inverse
    return solution, spread.T @ spread, noise


@dataclass(frozen=True)
class WeightedLeastSquares:
    """Weighted least squares."""

    name: str = "WLS"
    reference: str = "Gautier, Dynamic identification of robots with power model, IEEE ICRA 1997"
    assumptions: str = "white noise of its own size on the torque of each joint; q, v, a without error"
    needs: str = "q, v, a and actuator torques"
    takes_expected: ClassVar[bool] = True

    def estimate(self, problem: Problem) -> Estimate:
        solution, noise = weighted_solution(problem.equations)
        blocks = jackknife_covariance(problem.blocks, solution.x, noise)
        return base_estimate(problem, solution.x, solution.inverse, noise, block_covariance=blocks)


@dataclass(frozen=True)
class EssentialParameters:
    """Weighted least squares without the poorly determined parameters, which are removed one after the other.

    ratio: of the largest %σ to the smallest at which to stop
    increase: accepted rise of the root mean square of the weighted residual, relative
    """

    ratio: float = 30.0
    increase: float = 0.02
    name: str = "essential"
    reference: str = "Pham and Gautier, Essential parameters of robots, IEEE CDC 1991"
    assumptions: str = "as WLS, and parameters that cannot be told from zero are zero"
    needs: str = "q, v, a and actuator torques"
    takes_expected: ClassVar[bool] = True

    def estimate(self, problem: Problem) -> Estimate:
        full, noise = weighted_solution(problem.equations)
        kept, solution = essential(problem.equations, full, noise, self.ratio, self.increase)
        x, covariance = np.zeros(len(full.x)), np.zeros(full.inverse.shape)
        x[kept] = solution.x
        covariance[np.ix_(kept, kept)] = solution.inverse
        names = problem.base.names([column.symbol for column in problem.torque_model.columns])
        removed = [name for k, name in enumerate(names) if k not in kept]
        remarks = (f"set to zero: {'; '.join(removed)}",) if removed else ()
        return base_estimate(
            problem,
            x,
            covariance,
            noise,
            iterations=1 + len(removed),
            settings={"essential parameters": float(len(kept))},
            remarks=remarks,
        )


def essential(
    equations: CompressedEquations, full: Solution, noise: Array, ratio: float, increase: float
) -> tuple[NDArray[np.int64], Solution]:
    """Numbers of the parameters that stay, and their solution."""
    kept, solution = np.arange(len(full.x)), full
    limit = (1 + increase) ** 2 * np.sum(equations.residual_squares(full.x) / noise**2)
    while len(kept) > 1:
        relative = np.sqrt(np.diag(solution.inverse)) / np.maximum(np.abs(solution.x), np.finfo(float).tiny)
        if relative.max() <= ratio * relative.min():
            break
        fewer = np.delete(kept, int(np.argmax(relative)))
        selected = equations.selected(fewer)
        smaller = solve(selected, noise)
        if np.sum(selected.residual_squares(smaller.x) / noise**2) > limit:
            break
        kept, solution = fewer, smaller
    return kept, solution


@dataclass(frozen=True)
class TotalLeastSquares:
    """Total least squares.

    scaled: columns at unit length; otherwise the units of the parameters weigh the columns
    """

    scaled: bool = True
    reference: str = "Golub and Van Loan, SIAM J. Numerical Analysis 17(6), 1980"
    assumptions: str = "errors of all entries of the regressor independent and alike, which they are not"
    needs: str = "q, v, a and actuator torques"

    @property
    def name(self) -> str:
        return "TLS" if self.scaled else "TLS, unscaled"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem.

        Raises EstimationFailed if the singular vector of the smallest singular value has no torque component.
        """
        r, z = problem.equations.weighted(joint_noise(problem.equations))
        lengths = np.append(np.linalg.norm(r, axis=0), np.linalg.norm(z)) if self.scaled else np.ones(len(z))
        *_, vectors = np.linalg.svd(np.column_stack([r, z]) / lengths)
        smallest = vectors[-1] / lengths
        if abs(vectors[-1, -1]) <= EPS:
            raise EstimationFailed("total least squares has no solution: the smallest singular vector has no torque")
        x = -smallest[:-1] / smallest[-1]
        remark = (
            "errors of a regressor are neither independent nor alike: WLS, or the simulated loop, are better founded"
        )
        return Estimate(model_prior(problem.torque_model).nearest(problem.base, x), remarks=(remark,))
