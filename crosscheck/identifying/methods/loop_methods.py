"""Methods that simulate the control loop of the recording, and the test of exogeneity for the other methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from crosscheck.identifying.preparing.preparation import Preparation
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
from graphdyn.identification.closed_loop import EXOGENEITY_SETTING, Exogeneity, SimulatedLoop, exogeneity

CLOSED_LOOP_METHODS = (InstrumentalVariables, DirectInverse, ClosedLoopOutputError)


def as_prepared(loop: ClosedLoop | None, preparation: Preparation, recording: Recording) -> ClosedLoop | None:
    """The loop with the preparation of torques and motions."""
    if loop is None:
        return None
    return replace(loop, torque_hold=preparation.torque_hold, differentiation=preparation.differentiation(recording))


def in_loop(estimators: Sequence[Estimator], loop: ClosedLoop | None) -> list[Estimator]:
    """The estimators; those that simulate the loop and have none receive it."""
    return [
        replace(estimator, loop=loop)
        if isinstance(estimator, CLOSED_LOOP_METHODS) and estimator.loop is None
        else estimator
        for estimator in estimators
    ]


EXOGENEITY_NOT_TESTED = "not tested: the test needs the simulated loop of the recording (controller and reference)"
"""Text on the exogeneity of the regressor without a known loop."""


def with_exogeneity(
    comparison: MethodComparison, problem: Problem, loop: ClosedLoop | None
) -> tuple[MethodComparison, str]:
    """The test of the regressor in every result, and as text, with instruments from the first result that the loop
    holds.

    Without a loop the comparison stays as it was. If the loop holds no result, every result states why there is no
    test.
    """
    if loop is None:
        return comparison, EXOGENEITY_NOT_TESTED
    test = _test(comparison, problem, loop)
    if isinstance(test, str):
        words, settings = f"exogeneity of the regressor not tested: {test}", {}
    else:
        words = test.in_words(problem.torque_model.model.independent_joints)
        settings = {EXOGENEITY_SETTING: test.together}
    results = []
    for result in comparison.results:
        estimate = result.estimate
        if estimate is not None and EXOGENEITY_SETTING not in estimate.settings:
            told = replace(estimate, settings={**estimate.settings, **settings}, remarks=(*estimate.remarks, words))
            result = replace(result, estimate=told)
        results.append(result)
    return replace(comparison, results=tuple(results)), words


def _test(comparison: MethodComparison, problem: Problem, loop: ClosedLoop) -> Exogeneity | str:
    """The test, or the reason why there is none."""
    reason = "no method has a result"
    for result in comparison.results:
        if result.estimate is None or result.base_values is None:
            continue
        try:
            simulated = SimulatedLoop(problem, loop)
            return exogeneity(simulated, result.base_values, simulated.samples(result.estimate.parameters))
        except EstimationFailed as failure:  # this result drives the simulated robot away
            reason = f"{result.name}: {failure}"
    return reason
