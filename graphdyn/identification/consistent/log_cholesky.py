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

The coordinates of an inertia are ten unbounded numbers, each choice of them a physically consistent body:

    P = U Uᵀ,   U = e^α [e^d₁ s₁₂ s₁₃ t₁; 0 e^d₂ s₂₃ t₂; 0 0 e^d₃ t₃; 0 0 0 1]
    θ = (α, d₁, d₂, d₃, s₁₂, s₂₃, s₁₃, t₁, t₂, t₃)

α, d scale the body, s shear it, t moves its center of mass, from the body of θ = 0 whose P is the unit matrix.

Rucker and Wensing, "Smooth parameterization of rigid-body inertia", IEEE Robotics and Automation Letters 7(2), 2022.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.bodies.inequalities import VIOLATION_TOLERANCE
from graphdyn.identification.consistent.coordinates import SYMMETRIC_BASIS, PriorCoordinates, upper_factor
from graphdyn.identification.consistent.fit import MIN_MARGIN_SHARE, PRIOR_MARGIN, ConsistentFit
from graphdyn.identification.consistent.polishing import FURTHER_COLUMN_WEIGHT, Cost, polished, suboptimality
from graphdyn.layout import BODY_PARAMETERS, Array

log = logging.getLogger(__name__)

_STRETCHES = (0, 1, 2)
_PLACES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))  # of s₁₂, s₂₃, s₁₃, t₁, t₂, t₃


def log_cholesky_factor(theta: Array) -> Array:
    """U (…, 4, 4) of θ (…, 10)."""
    u = np.zeros((*theta.shape[:-1], 4, 4))
    for k in _STRETCHES:
        u[..., k, k] = np.exp(theta[..., 1 + k])
    for k, (row, column) in enumerate(_PLACES, start=4):
        u[..., row, column] = theta[..., k]
    u[..., 3, 3] = 1.0
    return np.exp(theta[..., 0])[..., None, None] * u


def log_cholesky_factor_derivatives(theta: Array) -> Array:
    """∂U/∂θ_k (…, 10, 4, 4) of θ (…, 10)."""
    u = log_cholesky_factor(theta)
    d = np.zeros((*theta.shape[:-1], BODY_PARAMETERS, 4, 4))
    d[..., 0, :, :] = u
    for k in _STRETCHES:
        d[..., 1 + k, k, k] = u[..., k, k]
    for k, (row, column) in enumerate(_PLACES, start=4):
        d[..., k, row, column] = np.exp(theta[..., 0])
    return d


def log_cholesky_pseudo_inertia(theta: Array) -> Array:
    """P = U Uᵀ (…, 4, 4) of θ (…, 10)."""
    u = log_cholesky_factor(theta)
    return u @ np.swapaxes(u, -1, -2)


def log_cholesky_pseudo_inertia_derivatives(theta: Array) -> Array:
    """∂P/∂θ_k = ∂U/∂θ_k Uᵀ + U ∂Uᵀ/∂θ_k (…, 10, 4, 4)."""
    half = log_cholesky_factor_derivatives(theta) @ np.swapaxes(log_cholesky_factor(theta), -1, -2)[..., None, :, :]
    return half + np.swapaxes(half, -1, -2)


def log_cholesky_parameters(matrix: Array) -> Array:
    """θ (…, 10) of positive definite P (…, 4, 4). Raises numpy.linalg.LinAlgError if P is not positive definite."""
    u = upper_factor(matrix)
    unit = u / u[..., 3:, 3:]
    theta = [np.log(u[..., 3, 3]), *(np.log(unit[..., k, k]) for k in _STRETCHES)]
    return np.stack([*theta, *(unit[..., row, column] for row, column in _PLACES)], axis=-1)


MAX_THETA = 40.0
"""Largest |θ| that has an effect: trial steps must not overflow, and e^-40 is negligible."""


class Residuals:
    """A u - b and √(strength / 2) (u - u of the prior) of the unknowns (θ of n bodies, further columns)."""

    def __init__(self, coordinates: PriorCoordinates, strength: float, margin: float):
        self.coordinates, self.margin, self.pull = coordinates, margin, np.sqrt(strength / 2)

    def u(self, unknowns: Array) -> Array:
        bodies = log_cholesky_pseudo_inertia(self._thetas(unknowns))
        s = self.margin * np.eye(4) + (1 - self.margin) * bodies
        return np.concatenate(
            [np.einsum("ijk,nij->nk", SYMMETRIC_BASIS, s).reshape(-1), unknowns[self.coordinates.width :]]
        )

    def residuals(self, unknowns: Array) -> Array:
        c, u = self.coordinates, self.u(unknowns)
        weight = self._weight(len(u))
        return np.concatenate([c.matrix @ u - c.right, weight * (u - c.origin)])

    def jacobian(self, unknowns: Array) -> Array:
        derivatives = log_cholesky_pseudo_inertia_derivatives(self._thetas(unknowns))
        blocks = (1 - self.margin) * np.einsum("ijk,nlij->nkl", SYMMETRIC_BASIS, derivatives)
        of_u = np.eye(len(unknowns))
        for i, block in enumerate(blocks):
            rows = slice(BODY_PARAMETERS * i, BODY_PARAMETERS * (i + 1))
            of_u[rows, rows] = block
        return np.concatenate([self.coordinates.matrix @ of_u, self._weight(len(unknowns))[:, None] * of_u])

    def cost(self, unknowns: Array) -> float:
        return float(np.sum(self.residuals(unknowns) ** 2))

    def lifted(self, unknowns: Array, part: float) -> Array:
        """The unknowns with this fraction of the prior added to every body."""
        thicker = log_cholesky_pseudo_inertia(self._thetas(unknowns)) + part * np.eye(4)
        further = unknowns[self.coordinates.width :]
        return np.concatenate([log_cholesky_parameters(thicker).reshape(-1), further])

    def of_some(self, values: Array, free: NDArray[np.int64], others: Array) -> Array:
        """The residuals as a function of the free unknowns."""
        return self.residuals(with_values(others, free, values))

    def jacobian_of_some(self, values: Array, free: NDArray[np.int64], others: Array) -> Array:
        return self.jacobian(with_values(others, free, values))[:, free]

    def _thetas(self, unknowns: Array) -> Array:
        bodies = unknowns[: self.coordinates.width].reshape(-1, BODY_PARAMETERS)
        return np.clip(bodies, -MAX_THETA, MAX_THETA)

    def _weight(self, size: int) -> Array:
        pulls: Array = self.pull * np.where(
            np.arange(size) < self.coordinates.width, 1.0, np.sqrt(FURTHER_COLUMN_WEIGHT)
        )
        return pulls


def with_values(unknowns: Array, free: NDArray[np.int64], values: Array) -> Array:
    """The unknowns with these values at the free entries."""
    changed = unknowns.copy()
    changed[free] = values
    return changed


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
"""Largest excess of a solution's cost, relative to the cost or one variance: far less than noise moves the cost."""


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
class LogCholeskyFit(ConsistentFit):
    """The fit from all starts.

    starts: all of them, the chosen one first; agreeing: how many found its cost
    """

    starts: tuple[LocalMinimum, ...]
    agreeing: int


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
    c = coordinates
    bounded = np.concatenate([np.zeros(c.width, dtype=bool), nonnegative])
    random = np.random.default_rng(seed).normal(scale=START_DEVIATION, size=(starts - 1, c.width))
    tried = []
    for k, theta in enumerate((np.zeros(c.width), *random), start=1):
        log.info("log-Cholesky from start %d of %d", k, starts)
        tried.append(_from(c, theta, bounded, strength, margin))
    # the cost is not convex in θ: the cheapest of all starts counts
    tried.sort(key=lambda start: start.cost)
    best = tried[0]
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
    return LogCholeskyFit(c, u if best_fit else best.u, best_fit, tuple(tried), agreeing)


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
