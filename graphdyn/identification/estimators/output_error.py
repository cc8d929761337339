"""Output error of the simulated loop: on positions (CLOE), or on torques, the input of the robot (CLIE).

    minimize Σ_g ‖y_g - y_g(x)‖² / σ_g²,    y = q or τ

by the Gauss-Newton method with the sensitivities of whole simulations. No measurement is differentiated, and
none enters an equation twice: for white noise on the output this is maximum likelihood. Each iteration simulates the
loop 2 r + 1 times.

Landau and Karimi, Automatica 33(8), 1997; Gautier, Janot and Vandanjon, IEEE Transactions on Control Systems Technology
21(2), 2013, with a comparison with DIDIM.
"""

from __future__ import annotations

from dataclasses import dataclass

from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.closed_loop.equations import OutputFit, output_step
from graphdyn.identification.closed_loop.iterating import MAX_LOOP_ITERATIONS, iterated
from graphdyn.identification.closed_loop.loop import ClosedLoop, not_simulated
from graphdyn.identification.closed_loop.sensitivities import OutputName, outputs
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.estimators.starting import Beginning, starts, told
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class ClosedLoopOutputError:
    """Output error of the simulated loop.

    The standard parameters are those with the estimated base parameters that are nearest to the model's.

    output: "position" or "torque"
    loop, start, most: as in InstrumentalVariables

    Raises InvalidInput for another output.
    """

    output: OutputName = "position"
    loop: ClosedLoop | None = None
    start: Beginning = "wls"
    most: int = MAX_LOOP_ITERATIONS
    reference: str = "Landau and Karimi, Automatica 33(8), 1997; Gautier, Janot and Vandanjon 2013"
    assumptions: str = "white noise of its own size on the output of each joint, which the controller does not see"
    needs: str = "the controller of the loop, and the reference that it followed; every term of the torque simulated"

    def __post_init__(self) -> None:
        if self.output not in ("position", "torque"):
            raise InvalidInput(f"output is '{self.output}'; use 'position' or 'torque'")

    @property
    def name(self) -> str:
        return "CLOE" if self.output == "position" else "CLIE"

    def estimate(self, problem: Problem) -> Estimate:
        """Estimate of a problem.

        Raises EstimationFailed if the simulation does not know the loop or a term, or if the iteration diverges.
        """
        loop = SimulatedLoop(problem, self.loop)
        unknown = not_simulated(problem.torque_model)
        if unknown:
            raise EstimationFailed(f"a simulation does not know {', '.join(unknown)}; DIDIM and IDIM-IV need not")

        noise = problem.equations.noise if self.output == "torque" else None

        def step(x: Array, simulated: list[Samples]) -> OutputFit:
            return output_step(problem, x, outputs(loop, x, simulated, self.output), noise)

        return told(loop, iterated(loop, starts(problem, self.start), step, self.most), self.output)
