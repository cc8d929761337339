"""Direct and inverse dynamic identification (DIDIM): the output error of the torque in the simulated loop.

    minimize Σ_g ‖τ_g - τ_g(x)‖² / σ_g²,   dτ_g(x)/dx ≈ W_g of the simulated motion

τ(x) is the torque of the simulated loop. The controller makes the robot follow the reference whatever its parameters:
the motion hardly depends on them, and the torque depends on them as in the inverse dynamics. One simulation is
therefore enough for a Gauss-Newton step. Measured positions serve only as the start, so their noise and its
differentiation do not matter.

Gautier, Janot and Vandanjon, "A new closed-loop output error method for parameter identification of robot dynamics",
IEEE Transactions on Control Systems Technology 21(2), 2013.
"""

from __future__ import annotations

from dataclasses import dataclass

from graphdyn.identification.closed_loop.equations import OutputFit, beside, output_step
from graphdyn.identification.closed_loop.loop import ClosedLoop
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.estimators.iterating import MAX_LOOP_ITERATIONS, Beginning, iterated, starts, told
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class DirectInverse:
    """DIDIM. The standard parameters are those with the estimated base parameters that are nearest to the model's.

    loop, start, most: as in InstrumentalVariables
    """

    loop: ClosedLoop | None = None
    start: Beginning = "wls"
    most: int = MAX_LOOP_ITERATIONS
    name: str = "DIDIM"
    reference: str = "Gautier, Janot and Vandanjon, IEEE Trans. Control Systems Technology 21(2), 2013"
    assumptions: str = "white noise of its own size on the torque of each joint; a loop that follows its reference"
    needs: str = "actuator torques; the controller of the loop, and the reference that it followed; all of the friction"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem. Raises EstimationFailed if the loop is not known, or the iteration diverges."""
        loop = SimulatedLoop(problem, self.loop)

        def step(x: Array, simulated: list[Samples]) -> OutputFit:
            return output_step(problem, x, beside(problem, simulated), problem.equations.noise)

        return told(loop, iterated(loop, starts(problem, self.start), step, self.most))
