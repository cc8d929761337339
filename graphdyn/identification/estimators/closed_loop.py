"""Methods that simulate the loop of the recording: output errors, and instrumental variables.

Direct and inverse dynamic identification (DIDIM) takes the torque, and for its sensitivities the regressor:

    minimize Σ_g ‖τ_g - τ_g(x)‖² / σ_g²,   dτ_g(x)/dx ≈ W_g of the simulated motion

τ(x) is the torque of the simulated loop. The controller makes the robot follow the reference whatever its parameters:
the motion hardly depends on them, and the torque depends on them as in the inverse dynamics. One simulation is
therefore enough for a Gauss-Newton step. Measured positions serve only as the start, so their noise and its
differentiation do not matter.

Output errors on positions (CLOE), or on torques, the input of the robot (CLIE), take those of whole simulations:

    minimize Σ_g ‖y_g - y_g(x)‖² / σ_g²,    y = q or τ

by the Gauss-Newton method. No measurement is differentiated, and none enters an equation twice: for white noise on the
output this is maximum likelihood. The sensitivities solve the variational equations of the simulated motion
(closed_loop.sensitivities), and go through the same low-pass as the measured output. Each iteration simulates the loop
twice.

Instrumental variables (IDIM-IV):

    x = (Σ_g Z_gᵀ W_g / σ_g²)⁻¹ Σ_g Z_gᵀ τ_g / σ_g²

W has noise, because q, v and a are measured. In a closed loop the same noise is in τ, so least squares is biased,
whatever the length of the recording. Z is the regressor of the motion that the loop makes in simulation, with the
parameters of the previous iteration. It resembles W and is independent of the noise, so that Zᵀ(W x - τ) is zero at the
truth on average. Each joint is weighted by its own residual.

Gautier, Janot and Vandanjon, "A new closed-loop output error method for parameter identification of robot dynamics",
IEEE Transactions on Control Systems Technology 21(2), 2013; Landau and Karimi, Automatica 33(8), 1997; Janot, Vandanjon
and Gautier, "A generic instrumental variable approach for industrial robot identification", IEEE
Transactions on Control Systems Technology 22(1), 2014. They filter Z like W; here only W and τ are filtered (see
closed_loop.beside).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.algebra.compressed import residual_deviations
from graphdyn.identification.closed_loop.equations import CrossedEquations, LoopSolution, RowBlock, beside, output_step
from graphdyn.identification.closed_loop.iterating import MAX_LOOP_ITERATIONS, Beginning, iterated
from graphdyn.identification.closed_loop.loop import ClosedLoop, not_simulated
from graphdyn.identification.closed_loop.sensitivities import sensitivities
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
class DirectInverse:
    """DIDIM.

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

        def step(x: Array, simulated: list[Samples]) -> LoopSolution:
            return output_step(problem, x, beside(problem, simulated), problem.equations.noise)

        return iterated(loop, self.start, step, self.most)


OutputName = Literal["position", "torque"]


def outputs(loop: SimulatedLoop, x: Array, simulated: list[Samples], name: OutputName) -> Iterator[RowBlock]:
    """Measured and simulated outputs, with the sensitivities of the latter as the regressor.

    x: base parameters (r,) of the simulated motions. Raises EstimationFailed if the result does not fit in memory.
    """
    problem = loop.problem
    sensitivity = _sensitivity(loop, x, name, simulated)
    modeled = problem.chosen(np.concatenate([_output(loop, samples, name) for samples in simulated]))
    measured = problem.chosen(loop.measured_positions()) if name == "position" else None
    position = 0
    for rows in problem.rows():
        here = slice(position, position + len(rows))
        position = here.stop
        seen = rows if measured is None else replace(rows, measured=measured[here])
        yield RowBlock(seen, problem.reduced(rows), sensitivity[here], modeled[here])


def _sensitivity(loop: SimulatedLoop, x: Array, name: OutputName, like: list[Samples]) -> Array:
    """Sensitivities of the outputs (N, n, r) for the rows of the problem. like: samples with the filters."""
    parts = [
        np.stack(
            [
                _output(loop, replace(motion, q=q, tau=tau), name)
                for q, tau in zip(np.moveaxis(by_q, -1, 0), np.moveaxis(by_tau, -1, 0), strict=True)
            ],
            axis=-1,
        )
        for motion, (by_q, by_tau) in zip(like, sensitivities(loop, x), strict=True)
    ]
    return loop.problem.chosen(np.concatenate(parts))


def _output(loop: SimulatedLoop, samples: Samples, name: OutputName) -> Array:
    """Output of one stretch, as measured, in the rows that the filter keeps (N, n)."""
    row_filter = samples.row_filter
    if name == "torque":
        return samples.tau if row_filter is None else row_filter(samples.tau)
    return loop.loop.seen(samples).q[:: 1 if row_filter is None else row_filter.factor]


@dataclass(frozen=True, eq=False)
@short_repr
class ClosedLoopOutputError:
    """Output error of the simulated loop.

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

        def step(x: Array, simulated: list[Samples]) -> LoopSolution:
            return output_step(problem, x, outputs(loop, x, simulated, self.output), noise)

        return iterated(loop, self.start, step, self.most, self.output)


@dataclass(frozen=True, eq=False)
@short_repr
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
