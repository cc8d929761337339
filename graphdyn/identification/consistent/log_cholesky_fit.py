"""Nonlinear least squares in log-Cholesky coordinates: consistent bodies without constraints or cone solver.

    minimize  ‖A u(θ, f) - b‖² + strength · ½ ‖S(θ) - E‖²,   S_i = margin · E + (1 - margin) U(θ_i) U(θ_i)ᵀ

over θ, ten numbers per body, θ = 0 at the prior, and the further columns f. It is the problem of the convex fit with
the quadratic distance in other unknowns, and not convex in θ. Each start follows a path of falling strengths, and each
solution is the start of the next. The data bend the valley of the cost, and the prior straightens it. The method is
that of Levenberg and Marquardt (MINPACK, through scipy.optimize.least_squares) with the analytic Jacobian. Columns that
cannot be negative but would become so are held at zero, and released when the cost would fall.

Towards a body on the margin some entries of θ run to -∞, where the method converges slowly and may
stop too early. Solutions are therefore moved off the margin and solved for again. The certificate of the convex
problem decides on a solution, not the condition that stopped the method. Off the margin, Newton's method adds the last
digits.

If the shortest move of a solution into the best fits of unconstrained least squares stays off the
margin, it is made: the base parameters are then those of least squares, to the last digit.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.consistent.coordinates import PriorCoordinates
from graphdyn.identification.consistent.fit import MIN_MARGIN_SHARE, PRIOR_MARGIN, VIOLATION_TOLERANCE
from graphdyn.identification.consistent.log_cholesky import Residuals, with_values
from graphdyn.identification.consistent.polishing import Cost, polished, suboptimality
from graphdyn.layout import Array

START_DEVIATION = 0.5
"""Standard deviation of θ of the further starts: masses and lengths within a factor of 1.6 of the prior."""

PRIOR_STRENGTH = 1.0
"""Default strength: expects the entries of a body within √2 of the prior, relative. A hundredth of it takes hundreds of
iterations if the data want a body on the margin."""

STRENGTH_PATH = (1e4, 1e3, 1e2, 1e1, 1e0, 1e-1, 1e-2)
"""Decreasing strengths that are solved before a smaller one."""

MIN_RELATIVE_CHANGE = 1e-8
"""Relative change of the unknowns and of the cost at which least_squares stops."""

MAX_EVALUATIONS = 500

PRIOR_LIFT = 1e-2
"""Fraction of the prior that is added to every body before the last strength is solved again: a step that overshoots
leaves a column of U at zero, where the gradient vanishes although the cost would fall."""

MAX_LIFTS = 2

ZERO_COLUMN_NORM = 1e-12
"""Largest rounding of a zero column, relative to a column that makes the whole torque."""

MAX_ZERO_SETS = 10
"""Largest number of sets of columns held at zero that are tried at each strength."""

MAX_FIT_COST_EXCESS = 1e-2
"""Largest amount of a solution's cost above the minimum, relative to the cost or one variance of the residuals: far
less than noise moves the cost."""


@dataclass(frozen=True, eq=False)
class LocalMinimum:
    """The result of one start.

    cost: ‖A u - b‖² + strength · ½ ‖S - E‖²
    suboptimality: bound on the cost above its minimum
    stopped: message of least_squares on its end
    evaluations: of the residuals
    """

    u: Array
    cost: float
    suboptimality: float
    stopped: str
    evaluations: int

    @property
    def accepted(self) -> bool:
        return self.suboptimality <= MAX_FIT_COST_EXCESS * max(1.0, self.cost)


@dataclass(frozen=True, eq=False)
class LogCholeskyFit:
    """Result of the fit from all starts.

    parameters: x (p,); excess, eigenvalues, best_fit: see ConsistentFit
    starts: all of them, the chosen one first; agreeing: how many found its cost
    seconds: of all starts
    """

    parameters: Array
    excess: float
    eigenvalues: Array
    best_fit: bool
    starts: tuple[LocalMinimum, ...]
    agreeing: int
    seconds: float


def log_cholesky_fit(
    coordinates: PriorCoordinates,
    nonnegative: NDArray[np.bool_],
    *,
    strength: float = PRIOR_STRENGTH,
    starts: int = 3,
    margin: float = PRIOR_MARGIN,
    seed: int = 0,
) -> LogCholeskyFit:
    """Fit from several starts: the first is the prior, the others are drawn around it. The cheapest solution is taken.

    nonnegative: which further columns cannot be negative (k,).
    Raises InvalidInput for less than one start or a strength of 0, EstimationFailed if the cheapest is not accepted.
    """
    if starts < 1 or not strength > 0:
        raise InvalidInput(f"{starts} starts with strength {strength:g}; at least one, and a strength > 0 needed")
    c, begin = coordinates, time.perf_counter()
    bounded = np.concatenate([np.zeros(c.width, dtype=bool), nonnegative])
    random = np.random.default_rng(seed).normal(scale=START_DEVIATION, size=(starts - 1, c.width))
    tried = [_from(c, theta, bounded, strength, margin) for theta in (np.zeros(c.width), *random)]
    # the cost is not convex in θ: the cheapest of all starts counts
    tried.sort(key=lambda start: start.cost)
    seconds, best = time.perf_counter() - begin, tried[0]
    if not best.accepted:
        raise EstimationFailed(
            f"log-Cholesky: the cheapest of {starts} starts may be {best.suboptimality:.2g} above the minimal cost, it "
            f"came to {best.cost:.4g}: {best.stopped}"
        )
    agreeing = sum(start.cost <= best.cost + MAX_FIT_COST_EXCESS * max(1.0, best.cost) for start in tried)
    # the shortest move into the best fits; made if bodies stay off the margin and columns stay ≥ 0
    u = c.nearest_best_fit(best.u, bounded & (best.u <= VIOLATION_TOLERANCE))
    best_fit = bool(
        np.all(c.smallest_eigenvalues(u) >= MIN_MARGIN_SHARE * margin) and np.all(u[bounded] >= -ZERO_COLUMN_NORM)
    )
    u = u if best_fit else best.u
    x = c.fitting_parameters(u) if best_fit else c.parameters(u)
    excess = 0.0 if best_fit else c.excess(u)
    return LogCholeskyFit(x, excess, c.smallest_eigenvalues(u), best_fit, tuple(tried), agreeing, seconds)


def _from(
    coordinates: PriorCoordinates, theta: Array, bounded: NDArray[np.bool_], strength: float, margin: float
) -> LocalMinimum:
    """Solution from these bodies, and from the further columns of unconstrained least squares."""
    unknowns = np.concatenate([theta, coordinates.fitting[coordinates.width :]])
    evaluations = 0
    # from a strong pull to the prior, which straightens the valley, to the wanted one, each from the last solution
    for on_the_way in (*(larger for larger in STRENGTH_PATH if larger > strength), strength):
        problem = Residuals(coordinates, on_the_way, margin)
        unknowns, used, stopped = _settled(problem, unknowns, bounded)
        evaluations += used
    # off the margin, then down again: kept only where the cost falls by more than the stopping rule leaves
    for _ in range(MAX_LIFTS):
        lifted, used, message = _settled(problem, problem.lifted(unknowns, PRIOR_LIFT), bounded)
        evaluations += used
        if not problem.cost(lifted) < (1 - MIN_RELATIVE_CHANGE) * problem.cost(unknowns):
            break
        unknowns, stopped = lifted, message
    u = problem.u(unknowns)
    cost = Cost(coordinates, "pullback", strength)
    rows, zeros = np.eye(len(u))[bounded], np.zeros(np.count_nonzero(bounded))
    # multipliers of u ≥ 0: where a column is held at zero, the slope of the cost there
    pushes = np.where(rows @ u == 0, np.maximum(0.0, rows @ cost.gradient(u)), 0.0)
    u, pushes = polished(cost, u, pushes, (rows, zeros), margin)
    above = suboptimality(cost, u, rows, zeros, pushes, margin)
    return LocalMinimum(u, cost.value(u), above, stopped, evaluations)


def _settled(problem: Residuals, unknowns: Array, bounded: NDArray[np.bool_]) -> tuple[Array, int, str]:
    """The unknowns at one strength, evaluations, and the message of least_squares on its end."""
    from scipy.optimize import least_squares  # imported where first used: import graphdyn stays light

    evaluations = 0
    # an active-set method around Levenberg-Marquardt, which knows no bounds
    held = bounded & (unknowns <= 0)
    for _ in range(MAX_ZERO_SETS):
        unknowns = np.where(held, 0.0, unknowns)
        free = np.flatnonzero(~held)
        found = least_squares(
            problem.of_some,
            unknowns[free],
            jac=problem.jacobian_of_some,
            args=(free, unknowns),
            method="lm",
            xtol=MIN_RELATIVE_CHANGE,
            ftol=MIN_RELATIVE_CHANGE,
            gtol=MIN_RELATIVE_CHANGE,
            max_nfev=MAX_EVALUATIONS,
        )
        unknowns = with_values(unknowns, free, found.x)
        evaluations += int(found.nfev)
        # half the gradient of the cost: a held column is released where the cost falls with it
        slope = problem.jacobian(unknowns).T @ problem.residuals(unknowns)
        negative, wanted = bounded & (unknowns < 0), held & (slope < 0)
        if not negative.any() and not wanted.any():
            break
        held = (held & ~wanted) | negative
    return np.where(bounded, np.maximum(unknowns, 0.0), unknowns), evaluations, str(found.message)
