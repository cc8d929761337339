"""Methods that simulate the control loop of the recording, and what its simulation says about the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from crosscheck.identifying.preparation import Preparation
from crosscheck.recordings import Recording
from graphdyn import EstimationFailed
from graphdyn.identification import (
    ClosedLoop,
    ClosedLoopOutputError,
    DirectInverse,
    Estimator,
    InstrumentalVariables,
    MethodComparison,
    Problem,
)
from graphdyn.identification.closed_loop import SimulatedLoop
from graphdyn.identification.closed_loop.exogeneity import EXOGENEITY, Exogeneity, exogeneity

IN_LOOP = (InstrumentalVariables, DirectInverse, ClosedLoopOutputError)


def as_prepared(loop: ClosedLoop | None, preparation: Preparation, recording: Recording) -> ClosedLoop | None:
    """The loop with what the preparation does to torques and motions."""
    if loop is None:
        return None
    return replace(loop, torque_hold=preparation.torque_hold, differentiation=preparation.differentiation(recording))


def in_loop(estimators: Sequence[Estimator], loop: ClosedLoop | None) -> list[Estimator]:
    """The estimators; those that simulate the loop and know none are given it."""
    return [
        replace(estimator, loop=loop) if isinstance(estimator, IN_LOOP) and estimator.loop is None else estimator
        for estimator in estimators
    ]


def with_exogeneity(comparison: MethodComparison, problem: Problem, loop: ClosedLoop | None) -> MethodComparison:
    """The test of the regressor in the settings of every result, with instruments from the first that the loop holds.

    Without a loop, or where it holds no result, the comparison as it is.
    """
    test = None if loop is None else _test(comparison, problem, loop)
    if test is None:
        return comparison
    results = []
    for result in comparison.results:
        estimate = result.estimate
        if estimate is not None and EXOGENEITY not in estimate.settings:
            remarks = (*estimate.remarks, test.in_words(problem.torque_model.model.independent_joints))
            settings = {**estimate.settings, EXOGENEITY: test.together}
            result = replace(result, estimate=replace(estimate, settings=settings, remarks=remarks))
        results.append(result)
    return replace(comparison, results=tuple(results))


def _test(comparison: MethodComparison, problem: Problem, loop: ClosedLoop) -> Exogeneity | None:
    for result in comparison.results:
        if result.estimate is None or result.base_values is None:
            continue
        try:
            simulated = SimulatedLoop(problem, loop)
            return exogeneity(simulated, result.base_values, simulated.samples(result.estimate.parameters))
        except EstimationFailed:  # this result drives the simulated robot away
            continue
    return None
