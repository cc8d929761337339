"""Repeated simulation and estimation until the estimate converges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.algebra.compressed import weighted_solution
from graphdyn.identification.closed_loop.equations import LoopSolution
from graphdyn.identification.closed_loop.exogeneity_test import EXOGENEITY_SETTING, exogeneity
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.problem import Problem
from graphdyn.layout import Array

MAX_CONVERGED_STEP = 0.1
"""Step of a base parameter, in its standard deviations, below which it counts as converged."""

MIN_DEVIATION_SHARE = 1e-6
"""Smallest standard deviation that counts, relative to the torque: exact data have none."""

MAX_LOOP_ITERATIONS = 10
"""Iterations after which an estimate that still moves has diverged."""

MAX_STEP_HALVINGS = 6
"""Times that a step is halved if the simulated loop does not hold the robot at its end: to 1/64 of it."""


Beginning = ArrayLike | Literal["wls", "cad"]


class InitialEstimate(NamedTuple):
    """Initial values: base parameters (r,), and their origin as text."""

    x: Array
    words: str


def iterated(
    loop: SimulatedLoop,
    start: Beginning,
    step: Callable[[Array, list[Samples]], LoopSolution],
    most: int = MAX_LOOP_ITERATIONS,
    output: Literal["torque", "position"] = "torque",
) -> Estimate:
    """Iterate from the first initial values with which the simulated loop holds the robot.

    step: from base parameters (r,) and the motions simulated with them to the next ones
    output: whose noise the solutions have

    Raises EstimationFailed if the loop holds the robot with none of them, and if the estimate does not converge.
    """
    x, simulated, remarks = _begun(loop, starts(loop.problem, start))
    moved, resolved = np.inf, _resolved(loop)
    for iteration in range(1, most + 1):
        found = step(x, simulated)
        covariance = found.covariance if found.block_covariance is None else found.block_covariance
        deviations = np.maximum(np.sqrt(np.maximum(np.diag(covariance), 0.0)), resolved)
        moved = float(np.abs((found.x - x) / deviations).max(initial=0.0))
        if moved < MAX_CONVERGED_STEP:
            test = exogeneity(loop, found.x, simulated)
            counts = {"simulations": float(loop.simulations), "last step": moved}
            return base_estimate(
                loop.problem,
                found.x,
                found.covariance,
                found.noise if output == "torque" else None,
                block_covariance=found.block_covariance,
                iterations=iteration,
                settings={**counts, EXOGENEITY_SETTING: test.together},
                remarks=(*remarks, test.in_words(loop.problem.torque_model.model.independent_joints)),
            )
        x, simulated = _as_far_as_held(loop, x, found.x)
    raise EstimationFailed(
        f"diverged: after {most} simulations of the loop the estimate still moves by {moved:.2g} standard deviations; "
        "check controller and reference, filter the recording, leave slow rows out (min_speed), start nearer"
    )


def _resolved(loop: SimulatedLoop) -> Array:
    """Changes of base parameters (r,) that change the torque by MIN_DEVIATION_SHARE."""
    equations = loop.problem.equations
    columns = np.linalg.norm(equations.factors[..., :-1], axis=(0, 1))
    return np.asarray(MIN_DEVIATION_SHARE * np.sqrt(equations.measured_squares.sum()) / columns)


def _begun(loop: SimulatedLoop, starts: Sequence[InitialEstimate]) -> tuple[Array, list[Samples], tuple[str, ...]]:
    remarks: tuple[str, ...] = ()
    for start in starts:
        try:
            return start.x, _simulated(loop, start.x), remarks
        except EstimationFailed as failure:
            remarks = (*remarks, f"from {start.words}: {failure}")
    raise EstimationFailed("; ".join(remarks))


def _as_far_as_held(loop: SimulatedLoop, x: Array, wanted: Array) -> tuple[Array, list[Samples]]:
    """The wanted parameters, or those nearest to them on the way from x with which the loop holds the robot."""
    for halvings in range(MAX_STEP_HALVINGS + 1):
        there = x + (wanted - x) / 2**halvings
        try:
            return there, _simulated(loop, there)
        except EstimationFailed as failure:
            reason = failure
    raise EstimationFailed(f"diverged: {reason}, however short the step")


def _simulated(loop: SimulatedLoop, x: Array) -> list[Samples]:
    problem = loop.problem
    return loop.samples(model_prior(problem.torque_model).nearest(problem.base, x))


def starts(problem: Problem, beginning: Beginning) -> list[InitialEstimate]:
    """Initial values: the given parameters (p,), weighted least squares, or CAD without friction, which replaces the
    others.

    Raises InvalidInput for other words, and parameters of another number.
    """
    cad = InitialEstimate(problem.base.values(problem.torque_model.prior()), "CAD")
    if isinstance(beginning, str):
        if beginning not in ("wls", "cad"):
            raise InvalidInput(f"start is '{beginning}'; give 'wls', 'cad', or parameters")
        return [cad] if beginning == "cad" else [InitialEstimate(weighted_solution(problem.equations)[0].x, "WLS"), cad]
    given, expected = as_floats("start", beginning), (len(problem.torque_model.columns),)
    if given.shape != expected:
        raise InvalidInput(f"start has shape {given.shape}, expected {expected}")
    return [InitialEstimate(problem.base.values(given), "the parameters given"), cad]
