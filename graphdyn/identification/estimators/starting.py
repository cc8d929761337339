"""Initial values of an iteration with a simulated loop, and the report of its end."""

from __future__ import annotations

from typing import Literal

from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import InvalidInput
from graphdyn.identification.closed_loop.exogeneity_test import EXOGENEITY_SETTING, exogeneity
from graphdyn.identification.closed_loop.iterating import InitialEstimate, Iterated
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop
from graphdyn.identification.estimation.estimate import Estimate, base_estimate
from graphdyn.identification.estimators.weighted import weighted_solution
from graphdyn.identification.problem.problem import Problem

Beginning = ArrayLike | Literal["wls", "cad"]


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


def told(loop: SimulatedLoop, end: Iterated, output: Literal["torque", "position"] = "torque") -> Estimate:
    """The estimate, with the test of exogeneity and the number of simulations."""
    problem, last = loop.problem, end.last
    test = exogeneity(loop, last.x, end.simulated)
    joints = problem.torque_model.model.independent_joints
    return base_estimate(
        problem,
        last.x,
        last.covariance,
        last.noise if output == "torque" else None,
        block_covariance=last.block_covariance,
        iterations=end.iterations,
        settings={"simulations": float(loop.simulations), "last step": end.moved, EXOGENEITY_SETTING: test.together},
        remarks=(*end.remarks, test.in_words(joints)),
    )
