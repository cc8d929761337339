"""Essential parameters: weighted least squares on the base parameters that the data determine well.

The parameter with the largest relative standard deviation %σ = 100 σ / |x| is set to zero, and the rest is estimated
again. This ends when the largest %σ is below `ratio` times the smallest, or when one more removal would raise the
weighted residual by more than `increase` of itself. Khalil and Dombre, Modeling, Identification and Control of Robots,
2002, section 12.4; Pham and Gautier, "Essential parameters of robots", IEEE CDC 1991.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.algebra.compressed import CompressedEquations, Solution, solve, weighted_solution
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


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
