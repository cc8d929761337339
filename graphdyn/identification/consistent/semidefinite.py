"""The semidefinite programs of the physically consistent methods, in the coordinates of the prior.

    minimize    ‖A u - b‖² + strength · d(u)      over u = offset + basis y
    subject to  S_i ⪰ margin · E  for every body,  G u ≥ h

d is the entropic divergence or the quadratic pullback distance (polishing) of the bodies. A weak quadratic
of the further columns makes the minimum unique. The programs are written in the standard form of Clarabel,

    minimize  ½ xᵀP x + qᵀx   subject to   C x + s = c,   s in a product of cones,

whose semidefinite cone takes a symmetric matrix as its upper triangle, entries off the diagonal times √2. Those are the
coordinates of S in another order. log det S is the largest Σ log Z_kk for lower triangular Z with

    [S, Z; Zᵀ, diag Z] ⪰ 0,

and t ≤ log z is the exponential cone (Ben-Tal and Nemirovski, Lectures on Modern Convex Optimization, 2001, section
4.2). Offsets are best fits, so that the data term is that above its minimum, without the large ‖b‖² that would cancel.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from graphdyn.errors import EstimationFailed, not_installed
from graphdyn.identification.consistent.coordinates import IDENTITY_COORDINATES, SYMMETRIC_BASIS, PriorCoordinates
from graphdyn.identification.consistent.polishing import FURTHER_COLUMN_WEIGHT, Metric
from graphdyn.layout import BODY_PARAMETERS, Array

SOLVER_TOLERANCE = 1e-10
"""Relative gap and infeasibility at which Clarabel stops; it reports "AlmostSolved" if it cannot reach them."""

MAX_SOLVER_ITERATIONS = 200

OPTIMAL, INFEASIBLE = "Solved", "PrimalInfeasible"
"""Clarabel's words for an answer, and for limits that nothing keeps."""

USABLE = (OPTIMAL, "AlmostSolved", "MaxIterations", "MaxTime", "NumericalError", "InsufficientProgress")
"""Statuses with numbers that may be a solution, to be checked."""


@dataclass(frozen=True, eq=False)
class ConicAnswer:
    """The solver's solution and status.

    u: None if the solver gives none                        (p,)
    multipliers: of G u ≥ h, not negative                   (m,)
    status: of the solver (OPTIMAL, INFEASIBLE, "AlmostSolved", …), or its error message
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
    Raises EstimationFailed if Clarabel is not installed.
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
        solver_package()
        c = coordinates
        self._offset = c.fitting
        self._basis = c.null if on_best_fits else np.eye(len(c.origin))
        self._n_limits = len(inequalities[1])
        self._data = np.zeros((0, self._basis.shape[1])) if on_best_fits else c.matrix
        self._distance = _Distance(c, metric)
        self._constraints = _constraints(c, inequalities, metric, margin)

    def solve(self, strength: float, unit: float = 1.0) -> ConicAnswer:
        """Solve to SOLVER_TOLERANCE. unit: of the cost; the solver's tolerances count in it."""
        p, size, helpers, r = len(self._offset), self._basis.shape[1], len(self._distance.helpers), len(self._data)
        weight = strength / unit
        # x: y, helpers, residuals A basis y. Their squares as an own variable keep the digits that AᵀA loses
        quadratic = np.zeros((size + helpers + r, size + helpers + r))
        quadratic[:size, :size] = weight * (self._basis.T * self._distance.curvature) @ self._basis
        quadratic[size + helpers :, size + helpers :] = 2 * np.eye(r)
        slope = self._basis.T @ self._distance.slope(self._offset)
        linear = weight * np.concatenate([slope, self._distance.helpers, np.zeros(r)])
        matrix, right, cones = self._constraints
        of_u, of_helpers = matrix[:, :p], matrix[:, p:]
        residuals = np.hstack([self._data / np.sqrt(unit), np.zeros((r, helpers)), -np.eye(r)])
        bounded = np.hstack([of_u @ self._basis, of_helpers, np.zeros((len(matrix), r))])
        found = solved(
            quadratic,
            linear,
            np.vstack([residuals, bounded]),
            np.concatenate([np.zeros(r), right - of_u @ self._offset]),
            [*([("zero", r)] if r else []), *cones],
        )
        if isinstance(found, str):
            return ConicAnswer(None, np.zeros(0), found, np.nan, 0)
        x, dual, status, iterations = found
        usable = status in USABLE and bool(np.all(np.isfinite(x)))
        cost = unit * (x @ quadratic @ x / 2 + linear @ x) + strength * self._distance.constant(self._offset)
        return ConicAnswer(
            u=self._offset + self._basis @ x[:size] if usable else None,
            # the solver's multipliers of an inactive row may be slightly negative
            multipliers=unit * np.maximum(dual[r : r + self._n_limits], 0.0) if usable else np.zeros(0),
            status=status,
            objective=float(cost) if usable else np.nan,
            iterations=iterations,
        )


class _Distance:
    """d(u) as a quadratic form, and for the entropic one as a linear function of t ≤ log diag Z.

    curvature: diagonal of the second derivative            (p,)
    helpers: slope of d by the entries of every Z and t     (14 n,), none for the pullback
    """

    def __init__(self, coordinates: PriorCoordinates, metric: Metric):
        c = coordinates
        self.metric, self._n_bodies, self._origin = metric, c.n_bodies, c.origin
        self.curvature = np.full(len(c.origin), FURTHER_COLUMN_WEIGHT)
        self.curvature[: c.width] = 1.0 if metric == "pullback" else 0.0
        self.helpers = np.zeros(0)
        if metric == "entropic":
            self.helpers = np.tile(np.concatenate([np.zeros(BODY_PARAMETERS), -np.ones(4)]), c.n_bodies)

    def slope(self, offset: Array) -> Array:
        """Slope at this u (p,)."""
        slope = self.curvature * (offset - self._origin)
        if self.metric == "entropic":  # of tr S
            slope[: BODY_PARAMETERS * self._n_bodies] += np.tile(IDENTITY_COORDINATES, self._n_bodies)
        return slope

    def constant(self, offset: Array) -> float:
        """Value at this u, with t = 0."""
        value = float(np.sum(self.curvature * (offset - self._origin) ** 2) / 2)
        if self.metric == "entropic":
            bodies = offset[: BODY_PARAMETERS * self._n_bodies].reshape(-1, BODY_PARAMETERS)
            value += float((bodies @ IDENTITY_COORDINATES - 4).sum())
        return value


Constraints = tuple[Array, Array, list[tuple[str, int]]]
"""C, c and the cones of C (u, helpers) + s = c, each with its number of rows or the size of its matrix."""


def _constraints(
    coordinates: PriorCoordinates, inequalities: tuple[Array, Array], metric: Metric, margin: float
) -> Constraints:
    g, h = inequalities
    p, n = len(coordinates.origin), coordinates.n_bodies
    extra = BODY_PARAMETERS + 4 if metric == "entropic" else 0
    width = p + extra * n
    blocks = [np.hstack([-g, np.zeros((len(h), width - p))])]
    rights, cones = [-h], [("nonnegative", len(h))] if len(h) else []
    places = _triangle(4)
    for i in range(n):  # S - margin · E
        block = np.zeros((len(places), width))
        block[:, BODY_PARAMETERS * i : BODY_PARAMETERS * (i + 1)] = -places
        blocks.append(block)
        rights.append(-margin * places @ IDENTITY_COORDINATES)
        cones.append(("semidefinite", 4))
    for i in range(n if extra else 0):
        first = p + extra * i
        body, lower, logs = slice(BODY_PARAMETERS * i, BODY_PARAMETERS * (i + 1)), first, first + BODY_PARAMETERS
        of_s, of_z = _bordered()
        block = np.zeros((len(of_s), width))
        block[:, body], block[:, lower : lower + BODY_PARAMETERS] = -of_s, -of_z
        blocks.append(block)
        rights.append(np.zeros(len(of_s)))
        cones.append(("semidefinite", 8))
        for k, diagonal in enumerate(_DIAGONAL):  # (t, 1, z): 1 · exp(t / 1) ≤ z
            block = np.zeros((3, width))
            block[0, logs + k] = block[2, lower + diagonal] = -1.0
            blocks.append(block)
            rights.append(np.array([0.0, 1.0, 0.0]))
            cones.append(("exponential", 3))
    return np.vstack(blocks), np.concatenate(rights), cones


_LOWER = np.tril_indices(4)
_DIAGONAL = np.flatnonzero(_LOWER[0] == _LOWER[1])


def _packed(matrices: Array) -> Array:
    """Symmetric matrices (…, k, k) as the cone takes them: columns of the upper triangle, √2 off the diagonal."""
    columns, rows = np.tril_indices(matrices.shape[-1])
    entries: Array = matrices[..., rows, columns] * np.where(rows == columns, 1.0, np.sqrt(2.0))
    return entries


@cache
def _triangle(size: int) -> Array:
    """S = SYMMETRIC_BASIS @ s as the cone takes it: a permutation of s (10, 10)."""
    assert size == len(SYMMETRIC_BASIS)
    return _packed(np.moveaxis(SYMMETRIC_BASIS, -1, 0)).T


@cache
def _bordered() -> tuple[Array, Array]:
    """[S, Z; Zᵀ, diag Z] as the cone takes it, of s and of the entries of the lower triangle Z (36, 10) each."""
    of_s, of_z = np.zeros((2, BODY_PARAMETERS, 8, 8))
    of_s[:, :4, :4] = np.moveaxis(SYMMETRIC_BASIS, -1, 0)
    for k, (row, column) in enumerate(zip(*_LOWER, strict=True)):
        of_z[k, row, 4 + column] = of_z[k, 4 + column, row] = 1.0
        if row == column:
            of_z[k, 4 + row, 4 + row] = 1.0
    return _packed(of_s).T, _packed(of_z).T


def least_violations(coordinates: PriorCoordinates, inequalities: tuple[Array, Array], margin: float) -> Array:
    """Amounts (m,), of least sum, by which each inequality must be relaxed so that consistent bodies exist."""
    p, m = len(coordinates.origin), len(inequalities[1])
    matrix, right, cones = _constraints(coordinates, inequalities, "pullback", margin)
    # G u + short ≥ h and short ≥ 0
    with_short = np.hstack([matrix, np.zeros((len(matrix), m))])
    with_short[:m, p:] = -np.eye(m)
    not_negative = np.hstack([np.zeros((m, p)), -np.eye(m)])
    found = solved(
        np.zeros((p + m, p + m)),
        np.concatenate([np.zeros(p), np.ones(m)]),
        np.vstack([not_negative, with_short]),
        np.concatenate([np.zeros(m), right]),
        [("nonnegative", m), *cones],
    )
    if isinstance(found, str):
        raise EstimationFailed(found)
    return found[0][p:]


def solved(
    quadratic: Array, linear: Array, matrix: Array, right: Array, cones: list[tuple[str, int]]
) -> tuple[Array, Array, str, int] | str:
    """x and the multipliers of the rows, the status and the number of iterations; the message if the solver fails."""
    from scipy import sparse

    clarabel = solver_package()
    kinds = {
        "zero": clarabel.ZeroConeT,
        "nonnegative": clarabel.NonnegativeConeT,
        "semidefinite": clarabel.PSDTriangleConeT,
        "exponential": lambda _: clarabel.ExponentialConeT(),
    }
    options = clarabel.DefaultSettings()
    options.verbose, options.max_iter = False, MAX_SOLVER_ITERATIONS
    options.tol_gap_abs = options.tol_gap_rel = options.tol_feas = SOLVER_TOLERANCE
    try:
        solver = clarabel.DefaultSolver(
            sparse.csc_matrix(np.triu(quadratic)),
            linear,
            sparse.csc_matrix(matrix),
            right,
            [kinds[kind](size) for kind, size in cones],
            options,
        )
        found = solver.solve()
    except Exception as error:  # whatever the library raises, without a class of its own
        return f"failed: {error}"
    return np.array(found.x), np.array(found.z), str(found.status), int(found.iterations)


def solver_package() -> Any:
    """Clarabel, imported at first use: graphdyn works without it."""
    try:
        import clarabel
    except ImportError as error:
        raise EstimationFailed(
            f"physically consistent identification: {not_installed('clarabel', 'identify')} ({error})"
        ) from error
    return clarabel
