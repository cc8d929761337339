"""Instrumental variables from the simulated loop (IDIM-IV).

    x = (Σ_g Z_gᵀ W_g / σ_g²)⁻¹ Σ_g Z_gᵀ τ_g / σ_g²

W has noise, because q, v and a are measured. In a closed loop the same noise is in τ, so least squares is biased,
whatever the length of the recording. Z is the regressor of the motion that the loop makes in simulation, with the
parameters of the previous iteration. It resembles W and is independent of the noise, so that Zᵀ(W x - τ) is zero at the
truth on average. Each joint is weighted by its own residual.

Janot, Vandanjon and Gautier, "A generic instrumental variable approach for industrial robot identification", IEEE
Transactions on Control Systems Technology 22(1), 2014. They filter Z like W; here only W and τ are filtered (see
closed_loop.beside).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.identification.algebra.compressed import residual_deviations
from graphdyn.identification.closed_loop.equations import CrossedEquations, LoopSolution, beside
from graphdyn.identification.closed_loop.iterating import MAX_LOOP_ITERATIONS, Beginning, iterated
from graphdyn.identification.closed_loop.loop import ClosedLoop
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class InstrumentalVariables:
    """IDIM-IV.

    loop: the controller of the recording and its reference; without it there is no estimate
    start: of the iteration: "wls", "cad", or parameters of all columns of the torque model (p,)
    most: simulations after which an estimate that still moves counts as diverged
    """

    loop: ClosedLoop | None = None
    start: Beginning = "wls"
    most: int = MAX_LOOP_ITERATIONS
    name: str = "IDIM-IV"
    reference: str = "Janot, Vandanjon and Gautier, IEEE Trans. Control Systems Technology 22(1), 2014"
    assumptions: str = "noise on q, v, a and torques that the reference knows nothing of; controller and friction known"
    needs: str = "as WLS; the controller of the loop, and the reference that it followed"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed if the loop is not known, or the iteration diverges."""
        loop = SimulatedLoop(problem, self.loop)
        used = np.full(problem.n_joints, problem.base.rank / problem.n_joints)

        def step(x: Array, simulated: list[Samples]) -> LoopSolution:
            noise = residual_deviations(problem.equations, problem.equations.residual_squares(x), used)
            return CrossedEquations.of(beside(problem, simulated), problem.support).solve(noise)

        return iterated(loop, self.start, step, self.most)
