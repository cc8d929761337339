"""The semidefinite programs of the physically consistent methods, in the coordinates of the prior.

    minimize    ‖A u - b‖² + strength · d(u)      over u = offset + basis y
    subject to  S_i ⪰ margin · E  for every body,  G u ≥ h

d is the entropic divergence or the quadratic pullback distance (polishing) of the bodies. A weak quadratic
of the further columns makes the minimum unique. cvxpy writes the cone program, Clarabel solves it.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.consistent.coordinates import SYMMETRIC_BASIS, PriorCoordinates
from graphdyn.identification.consistent.polishing import FURTHER_COLUMN_WEIGHT, Metric
from graphdyn.layout import BODY_PARAMETERS, Array

SOLVER_TOLERANCE = 1e-10
"""Relative gap and infeasibility at which Clarabel stops; it reports "optimal_inaccurate" if it cannot reach them."""

MAX_SOLVER_ITERATIONS = 200


@dataclass(frozen=True, eq=False)
class ConicAnswer:
    """The solver's solution and status.

    u: None if the solver gives none                        (p,)
    multipliers: of G u ≥ h, not negative                   (m,)
    status: of the solver ("optimal", "optimal_inaccurate", "infeasible", …), or its error message
    objective: ‖A u - b‖² + strength d(u)
    iterations: of the solver
    """

    u: Array | None
    multipliers: Array
    status: str
    objective: float
    iterations: int


class SemidefiniteProgram:
    """One program, written once and solved for many strengths.

    on_best_fits: u is restricted to the best fits (the data term is then constant and left out), else any u
    inequalities: G (m, p), h (m,)
    Raises EstimationFailed if cvxpy or Clarabel is not installed.
    """

    def __init__(
        self,
        coordinates: PriorCoordinates,
        inequalities: tuple[Array, Array],
        *,
        metric: Metric,
        margin: float,
        on_best_fits: bool = False,
    ):
        cp = _cvxpy()
        if on_best_fits:
            # all best fits: one of them, and whatever the data do not determine
            y = cp.Variable(coordinates.null.shape[1])
            self._u: Any = coordinates.fitting + coordinates.null @ y
        else:
            self._u = cp.Variable(len(coordinates.origin))
        self._strength = cp.Parameter(nonneg=True)
        bodies = _bodies(self._u, coordinates.n_bodies)
        from_prior = self._u - coordinates.origin
        width = coordinates.width
        if metric == "entropic":
            # tr S - log det S - 4, the entropic divergence of S from E
            distance = cp.sum([cp.trace(s) - cp.log_det(s) - 4 for s in bodies])
        else:
            # ½ ‖S - E‖²: the entries off the diagonal are scaled by √2 in u, so that norms agree
            distance = cp.sum_squares(from_prior[:width]) / 2
        if len(coordinates.origin) > width:
            # without it the minimum would not be unique where data determine no friction
            distance = distance + FURTHER_COLUMN_WEIGHT / 2 * cp.sum_squares(from_prior[width:])
        cost = self._strength * distance
        if not on_best_fits:
            cost = cost + cp.sum_squares(coordinates.matrix @ self._u - coordinates.right)
        g, h = inequalities
        self._limits = [g @ self._u >= h] if len(h) else []
        # the cone: S_i - margin · E positive semidefinite
        real = [s >> margin * np.eye(4) for s in bodies]
        self._problem = cp.Problem(cp.Minimize(cost), real + self._limits)

    def solve(self, strength: float) -> ConicAnswer:
        """Solve at SOLVER_TOLERANCE, and once more at the solver's own default if it does not reach that."""
        self._strength.value = strength
        answer = self._solve(tol_gap_abs=SOLVER_TOLERANCE, tol_gap_rel=SOLVER_TOLERANCE, tol_feas=SOLVER_TOLERANCE)
        if answer.status in ("optimal", "infeasible"):
            return answer
        # where PRECISION is out of reach, the default may not be
        again = self._solve()
        return again if again.status == "optimal" or answer.u is None else answer

    def _solve(self, **settings: float) -> ConicAnswer:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # cvxpy's warnings repeat the status
            try:
                self._problem.solve(solver="CLARABEL", max_iter=MAX_SOLVER_ITERATIONS, **settings)
            except _cvxpy().SolverError as error:
                return ConicAnswer(None, np.zeros(0), f"failed: {error}", np.nan, 0)
        value = self._u.value
        usable = value is not None and bool(np.all(np.isfinite(value)))
        # the solver's multipliers of an inactive row may be slightly negative
        multipliers = [np.maximum(limit.dual_value, 0.0) for limit in self._limits if usable]
        return ConicAnswer(
            u=np.asarray(value, dtype=float) if usable else None,
            multipliers=np.concatenate([np.zeros(0), *multipliers]),
            status=self._problem.status,
            objective=float(self._problem.value) if usable else np.nan,
            iterations=int(self._problem.solver_stats.num_iters or 0),
        )


def least_violations(coordinates: PriorCoordinates, inequalities: tuple[Array, Array], margin: float) -> Array:
    """Amounts (m,), of least sum, by which each inequality must be relaxed so that consistent bodies exist."""
    cp = _cvxpy()
    g, h = inequalities
    u, short = cp.Variable(len(coordinates.origin)), cp.Variable(len(h), nonneg=True)
    real = [s >> margin * np.eye(4) for s in _bodies(u, coordinates.n_bodies)]
    cp.Problem(cp.Minimize(cp.sum(short)), [*real, g @ u + short >= h]).solve(solver="CLARABEL")
    return np.asarray(short.value, dtype=float)


def _bodies(u: Any, n: int) -> list[Any]:
    """Matrices S of the bodies, as expressions of cvxpy."""
    cp = _cvxpy()
    # columns are the basis matrices of S, written out, so that S is linear in its ten entries
    to_square = SYMMETRIC_BASIS.reshape(-1, BODY_PARAMETERS, order="F")
    parts = (u[BODY_PARAMETERS * i : BODY_PARAMETERS * (i + 1)] for i in range(n))
    return [cp.reshape(to_square @ s, (4, 4), order="F") for s in parts]


def _cvxpy() -> Any:
    """cvxpy, imported at first use: the import takes a second, and graphdyn works without it."""
    try:
        import clarabel  # noqa: F401
        import cvxpy
    except ImportError as error:
        raise EstimationFailed(
            f"physically consistent identification needs cvxpy and Clarabel ({error}); "
            "install them with: pip install 'graphdyn[identify]'"
        ) from error
    return cvxpy
