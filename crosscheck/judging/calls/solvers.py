"""Solvers of M a = τ - h, or of M X = 1, that are stopped early: their iterates from zero, compared with the answers.

Saad, "Iterative methods for sparse linear systems", 2003: sections 4.1 (Jacobi, Gauss-Seidel), 5.3 (steepest descent),
6.7 (conjugate gradients).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.calls.answered import Answered
from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.searching.found_fault import FIRST_TRIAL_STATES, FoundFault
from graphdyn.layout import Array

SOLVING_FUNCTIONS = ("forward_dynamics", "mass_matrix_inverse")
"""Functions that solve with the mass matrix."""

MAX_STEPS = 200
"""Number of steps of a method that are tried."""

EQUAL_ITERATE_SHARE = 1e-5
"""Part of the deviation within which an iterate is the answer: conjugate gradients amplify rounding."""

MAX_RESIDUAL = 1e-2
"""Largest backward error that is told as the residual of a solver; beyond, anything may be wrong."""

SOLVER_REMEDY = "take as many steps as the accuracy needs, or a Cholesky factorization"

Steps = Iterator[Array]
"""Iterates (N, n, m) after one step, two, …"""


def _jacobi(M: Array, b: Array) -> Steps:
    diagonal = np.einsum("nii->ni", M)[..., None]
    x = b / diagonal
    while True:
        yield x
        x = x + (b - M @ x) / diagonal


def _gauss_seidel(reverse: bool, M: Array, b: Array) -> Steps:
    triangle = np.triu(M) if reverse else np.tril(M)
    x: Any = np.linalg.solve(triangle, b)
    while True:
        yield x
        x = x + np.linalg.solve(triangle, b - M @ x)


def _descent(M: Array, b: Array) -> Steps:
    x = np.zeros_like(b)
    while True:
        r = b - M @ x
        x = x + _ratio(_dot(r, r), _dot(r, M @ r)) * r
        yield x


def _conjugate_gradients(scaled: bool, M: Array, b: Array) -> Steps:
    diagonal = np.einsum("nii->ni", M)[..., None] if scaled else 1.0
    x, r = np.zeros_like(b), b
    z = p = r / diagonal
    while True:
        Mp = M @ p
        length = _ratio(_dot(r, z), _dot(p, Mp))
        x, left = x + length * p, r - length * Mp
        y = left / diagonal
        p = y + _ratio(_dot(left, y), _dot(r, z)) * p
        r, z = left, y
        yield x


def _dot(x: Array, y: Array) -> Array:
    found: Array = (x * y).sum(axis=1, keepdims=True)
    return found


def _ratio(x: Array, y: Array) -> Array:
    return np.divide(x, y, out=np.zeros_like(x), where=np.abs(y) > 0)


SOLVERS: Mapping[str, Callable[[Array, Array], Steps]] = {
    "conjugate gradients": partial(_conjugate_gradients, False),
    "conjugate gradients scaled by the diagonal": partial(_conjugate_gradients, True),
    "Gauss-Seidel iteration": partial(_gauss_seidel, False),
    "Gauss-Seidel iteration from the last row": partial(_gauss_seidel, True),
    "Jacobi iteration": _jacobi,
    "steepest descent": _descent,
}
"""Methods by their names, those with the fewest steps first."""


def stopped_early(given: Answered) -> FoundFault | None:
    """A method and its number of steps, or of singular values, that gives the answers."""
    if given.name not in SOLVING_FUNCTIONS or not np.isfinite(given.answer).all():
        return None
    M, b = given.states.mass, _right_side(given)
    answer = given.answer if given.answer.ndim == 3 else given.answer[..., None]
    with np.errstate(all="ignore"):
        for name, method in SOLVERS.items():
            if found := _of_method(given, name, method, M, b, answer):
                return found
        return _cut_off(given, M, b, answer) or _within_few_powers(given, M, b, answer)


def _right_side(given: Answered) -> Array:
    """b (N, n, m) of M x = b."""
    ours = given.ours if given.ours.ndim == 3 else given.ours[..., None]
    right: Array = given.states.mass @ ours
    return np.broadcast_to(np.eye(len(right[0])), right.shape) if given.name == "mass_matrix_inverse" else right


def _equal(x: Array, given: Answered, answer: Array, rows: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Whether iterates are the answers, at each of some states."""
    right = given.ours[rows] if given.ours.ndim == 3 else given.ours[rows][..., None]
    off, deviation = (np.abs(y).max(axis=(1, 2)) for y in (x - answer[rows], right - answer[rows]))
    return np.asarray(
        np.isfinite(off) & (off <= EQUAL_ITERATE_SHARE * deviation + given.bound * np.abs(right).max(axis=(1, 2)))
    )


def _of_method(
    given: Answered, name: str, method: Callable[[Array, Array], Steps], M: Array, b: Array, answer: Array
) -> FoundFault | None:
    deviating = np.flatnonzero(given.errors(given.ours) > given.bound)
    few = deviating[:FIRST_TRIAL_STATES]
    first = _counts(method, M[few], b[few], given, answer, few)
    if not first.all():
        return None
    counts = _counts(method, M[deviating], b[deviating], given, answer, deviating)
    if not counts.all():
        return None
    left = EQUAL_ITERATE_SHARE * float(given.errors(given.ours).max())
    everywhere = np.arange(len(M))
    least, most = int(counts.min()), int(counts.max())
    steps = f"{least} step{'s' if least > 1 else ''}" if least == most else f"{least} to {most} steps"
    if most == 1:
        name = " or ".join(
            other for other, x in SOLVERS.items() if _equal(next(x(M, b)), given, answer, everywhere).all()
        )
    message = f"{_equation(given)} is solved by {name}, stopped after {steps} from zero"
    if least < most:
        message += f" with a residual of up to {_residual(given, M, b, answer):.1e} of the right side"
    return FoundFault(FaultDescription("stopped_solver", message, SOLVER_REMEDY), left, given.chosen)


def _counts(
    method: Callable[[Array, Array], Steps], M: Array, b: Array, given: Answered, answer: Array, rows: NDArray[np.intp]
) -> NDArray[np.intp]:
    """The number of steps that gives the answer of each state, 0 where none does."""
    counts = np.zeros(len(rows), dtype=np.intp)
    for k, x in zip(range(1, MAX_STEPS + 1), method(M, b), strict=False):
        counts = np.where((counts == 0) & _equal(x, given, answer, rows), k, counts)
        if counts.all() or not np.isfinite(x).any():
            break
    return counts


def _equation(given: Answered) -> str:
    return "M a = τ - h" if given.name == "forward_dynamics" else "M X = 1"


def _residual(given: Answered, M: Array, b: Array, answer: Array) -> float:
    size = np.abs(b).max(axis=(1, 2))
    found = np.abs(b - M @ answer).max(axis=(1, 2)) / np.where(size > 0, size, 1.0)
    return float(found.max())


def _cut_off(given: Answered, M: Array, b: Array, answer: Array) -> FoundFault | None:
    """The inverse without small singular values."""
    values, ways = np.linalg.eigh(M)
    along = np.swapaxes(ways, 1, 2) @ b / values[..., None]
    n, rows = M.shape[1], np.arange(len(M))
    used = np.zeros(len(M), dtype=np.intp)
    for cut in range(n):
        x = ways[:, :, cut:] @ along[:, cut:]
        used = np.where((used == 0) & _equal(x, given, answer, rows), cut + 1, used)
    if not used.all() or not (used > 1).any():
        return None
    relative = values / values[:, -1:]
    kept = relative[rows, used - 1].min()
    left_out = relative[rows, np.maximum(used - 2, 0)][used > 1].max()
    message = (
        f"{_equation(given)} is solved without the small singular values of M: those below a limit between "
        f"{left_out:.1e} and {kept:.1e} of the largest are cut off"
    )
    left = EQUAL_ITERATE_SHARE * float(given.errors(given.ours).max())
    return FoundFault(FaultDescription("stopped_solver", message, "M is regular: keep all of them"), left, given.chosen)


def _within_few_powers(given: Answered, M: Array, b: Array, answer: Array) -> FoundFault | None:
    """The answers are combinations of b, M b, … up to fewer powers than joints."""
    n = M.shape[1]
    basis = b / np.maximum(np.linalg.norm(b, axis=1, keepdims=True), np.finfo(float).tiny)
    columns = [basis]
    size = np.maximum(np.abs(answer).max(axis=1), np.finfo(float).tiny)
    for count in range(1, n):
        rest = answer
        for _ in range(2):
            for q in columns:
                rest = rest - _dot(q, rest) * q
        off = np.abs(rest).max(axis=1) / size
        if (off <= EQUAL_ITERATE_SHARE * 1e-2).all():
            message = (
                f"the answers are combinations of b, M b, … with {count} terms, where b is the right side of "
                f"{_equation(given)}: an iterative solver stopped after {count} step{'s' if count > 1 else ''}"
            )
            return FoundFault(
                FaultDescription("stopped_solver", message, SOLVER_REMEDY), float(off.max()), given.chosen
            )
        following = M @ columns[-1]
        for _ in range(2):
            for q in columns:
                following = following - _dot(q, following) * q
        columns.append(following / np.maximum(np.linalg.norm(following, axis=1, keepdims=True), np.finfo(float).tiny))
    return None


def residual_said(given: Answered) -> FoundFault | None:
    """The residual that the answers leave, where it is small."""
    if given.name not in SOLVING_FUNCTIONS or not np.isfinite(given.answer).all():
        return None
    answer = given.answer if given.answer.ndim == 3 else given.answer[..., None]
    size = _residual(given, given.states.mass, _right_side(given), answer)
    if not size <= MAX_RESIDUAL:
        return None
    message = (
        f"{_equation(given)} is left with a residual of up to {size:.1e} of the right side, as by a solver that is "
        "stopped early or by a slightly different matrix"
    )
    return FoundFault(FaultDescription("residual", message, SOLVER_REMEDY), np.inf, given.chosen)
