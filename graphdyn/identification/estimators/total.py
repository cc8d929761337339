"""Total least squares: errors in the regressor as well as in the torque. It serves only for comparison.

    minimize ‖[E | e]‖²   subject to   (W D⁻¹ + E) y = τ + e,   x = D⁻¹ y

with rows weighted by the noise of their joint and D the lengths of the columns: (x, -1) is the right singular vector of
the smallest singular value of [W D⁻¹ | τ / ‖τ‖]. It is right if the errors of all entries are independent and equally
large relative to their column. Those of W are neither: gravity has hardly any and inertia all, and the columns of one
sample share the errors of the same q, v and a. Without D the result depends on the units.

Golub and Van Loan, "An analysis of the total least squares problem", SIAM J. Numerical Analysis 17(6), 1980.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.compressed import EPS, joint_noise
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.problem import Problem


@dataclass(frozen=True)
class TotalLeastSquares:
    """Total least squares.

    The standard parameters are those with the estimated base parameters that are nearest to the model's.

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
