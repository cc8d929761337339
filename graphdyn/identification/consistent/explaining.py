"""Report of a physically consistent fit."""

from __future__ import annotations

from collections.abc import Mapping

from graphdyn.identification.consistent.coordinates import PriorCoordinates
from graphdyn.identification.consistent.fit import ConsistentFit
from graphdyn.identification.estimation.estimate import Estimate
from graphdyn.layout import Array


def consistent_estimate(
    coordinates: PriorCoordinates,
    fit: ConsistentFit,
    noise: Array,
    remarks: tuple[str, ...],
    settings: Mapping[str, float] | None = None,
) -> Estimate:
    """The estimate, with remarks on the constraints and on a solver status other than "optimal".

    If the base parameters equal those of weighted least squares, so does the covariance. Otherwise there is none: the
    constraints or the prior bias the estimate and reduce its scatter.
    """
    answer, low = fit.answer, float(fit.eigenvalues.min())
    if answer.status != "optimal":
        remarks += (
            f"Clarabel stopped with '{answer.status}'; the answer passed the checks: its cost {answer.objective:.4g} "
            f"is at most {fit.suboptimality:.1g} above the minimum, every body keeps {low:.1g} of its prior",
        )
    return Estimate(
        parameters=fit.parameters,
        covariance=coordinates.base_covariance if fit.best_fit else None,
        noise=noise,
        iterations=answer.iterations,
        settings={**(settings or {}), "smallest part of prior": low, "excess": fit.excess},
        remarks=(*remarks, constraint_remark(fit.best_fit, fit.excess)),
    )


def constraint_remark(best_fit: bool, excess: float) -> str:
    if best_fit:
        return "consistent parameters are among the best fits: base parameters and their covariance are those of WLS"
    return f"no best fit is consistent, or the prior counts: {excess:.4g} variances of one residual above WLS"
