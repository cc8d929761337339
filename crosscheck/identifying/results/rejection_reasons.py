"""Rejection reasons: why the best result should not be trusted, joint by joint.

A result is usable if its recording has no fault, and if every joint is predicted better than by a bound, a constant and
CAD with drives. Its residual must not exceed noise and repeatability, and the links must be physically consistent.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.identifying.data_quality.data_quality import DataQuality
from crosscheck.identifying.preparing.trials import Baselines
from crosscheck.identifying.results.recommending import joint_errors
from graphdyn.identification import MethodResult, Problem, weighted_solution
from graphdyn.layout import Array

MAX_RELATIVE_ERROR = 0.5
"""Largest error of a joint, ‖e‖ / ‖τ‖, on held-out rows: a quarter of the power of the torque is then unexplained."""

MAX_JOINT_ERROR_RATIO, MAX_MEAN_ERROR_RATIO = 1.5, 1.1
"""Largest error of one joint, and of the mean over the joints, relative to CAD with drives: links are fitted for all
joints together, and held-out rows are few."""

MIN_UNREPEATED_SHARE = 0.01
"""Fraction of a joint's torque that does not repeat, even with the best drives; a smaller residual needs no
explanation."""

MAX_CONSTRAINED_RATIO = 2.0
"""Largest residual of physically consistent parameters relative to that of unconstrained ones, which contains the noise
and the deficiencies of the torque model. For the arms of docs/industrial_arms.md it is 1.0 to 1.3, with one torque
reversed 1.5 to 30."""


def rejection_reasons(
    result: MethodResult | None,
    problem: Problem,
    joint_names: Sequence[str],
    baselines: Baselines,
    data_quality: DataQuality | None,
    *,
    unconstrained: Problem | None = None,
) -> tuple[str, ...]:
    """Rejection reasons as sentences; none for a result that can be trusted. problem: of the fit.

    unconstrained: problem of the fit with unknown links, if those of `problem` are known
    result: the best one, with an estimate; without one only the data quality of the recording counts
    """
    said = [finding.message for finding in data_quality.faults] if data_quality else []
    if result is None:
        return tuple(said)
    statistics = result.held_out or result.training
    assert statistics is not None
    assert result.base_values is not None
    errors = joint_errors(statistics)
    constant = joint_errors(baselines.constant)
    cad = joint_errors(baselines.cad) if baselines.cad else np.full(len(errors), np.inf)
    for j, name in enumerate(joint_names):
        if errors[j] > MAX_RELATIVE_ERROR:
            said.append(
                f"{name} is predicted with an error of {_percent(errors[j])}, more than {_percent(MAX_RELATIVE_ERROR)}"
            )
        elif errors[j] >= constant[j]:
            said.append(f"{name} is predicted no better than by a constant: {_against(errors[j], constant[j])}")
        elif errors[j] > MAX_JOINT_ERROR_RATIO * cad[j]:
            said.append(f"{name} is predicted worse than by CAD with fitted drives: {_against(errors[j], cad[j])}")
    mean, known = float(np.nanmean(errors)), float(np.nanmean(cad))
    if mean > MAX_MEAN_ERROR_RATIO * known:
        said.append(
            f"CAD with fitted drives predicts better on the mean over the joints: {_against(known, mean)}; "
            "use --known-bodies"
        )
    ratio = residual_ratio(problem, result.base_values, unconstrained)
    worst = int(np.argmax(ratio))
    if ratio[worst] > MAX_CONSTRAINED_RATIO:
        said.append(
            f"the residual of {joint_names[worst]} is {ratio[worst]:.3g} times that of parameters without constraints: "
            "real bodies and friction that brakes do not explain the recording"
        )
    return tuple(said)


def residual_ratio(problem: Problem, base_values: Array, unconstrained: Problem | None = None) -> Array:
    """Ratio of each joint's residual to that of weighted least squares (n,), neither below MIN_UNREPEATED_SHARE of τ.

    unconstrained: problem of the weighted least squares, the same if left out
    """
    equations, free_equations = problem.equations, (unconstrained or problem).equations
    least = MIN_UNREPEATED_SHARE**2 * free_equations.measured_squares
    solution, _ = weighted_solution(free_equations)
    own = np.maximum(equations.residual_squares(base_values), least)
    free = np.maximum(free_equations.residual_squares(solution.x), least)
    return np.asarray(np.sqrt(np.where(free > 0, own / np.where(free > 0, free, 1.0), 1.0)))


def _percent(error: float) -> str:
    return f"{100 * error:.1f} %"


def _against(error: float, other: float) -> str:
    return f"{_percent(error)} against {_percent(other)}"
