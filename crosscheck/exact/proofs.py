"""Statements about a robot that are proven or disproven: by fractions where they are decimals, else by balls."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal, Unpack

import numpy as np

from crosscheck.exact.balls import Balls, as_balls, bits, decimal, least_root, solved, zeros
from crosscheck.exact.equations import system
from crosscheck.exact.recorded import CONSTANTS, evaluate, recorded
from crosscheck.exact.robot import Truth
from crosscheck.exact.source import ExactSource
from crosscheck.exact.values import MAX_BITS
from crosscheck.reference.subject import Robot
from graphdyn import InvalidInput
from graphdyn.compiler import Request
from graphdyn.layout import BODY_DOF
from urdf import Reading, ReadingKeywords

Result = Literal["proven", "disproven", "not proven"]

Statement = Literal[
    "a real body can have this inertia",
    "the mass matrix is positive definite in all poses",
    "the mass matrix is positive definite at this state",
    "the constraints have full rank at this state",
    "the equations are regular at this state",
]

FIRST_BITS = 200
"""Precision with which the work begins; it doubles until MAX_BITS."""


@dataclass(frozen=True)
class Proof:
    """What is known of a statement.

    statement: what is said
    of: name of the link or body that it speaks of; empty where that is the whole robot
    result: "not proven" says that the statement may hold or not
    reason: what decides it, in words
    truth: of the decimals of the file, or of the doubles of the model
    """

    statement: Statement
    of: str
    result: Result
    reason: str
    truth: Truth


def prove(
    robot: Robot, q: Any = None, *, truth: Truth | None = None, **reading: Unpack[ReadingKeywords]
) -> tuple[Proof, ...]:
    """What can be proven of a robot: first of each inertia, then of all poses, then of one state.

    robot: name, path of a URDF, or RobotModel
    q: joint positions (n,) as in crosscheck.exact_values; without them nothing is said of a state   [rad or m]
    truth, reading: as in crosscheck.exact_values

    Of the file every <inertial> of a link is judged, of the model every body, but for those of zeros alone. A real body
    has positive mass, and principal moments of which none exceeds the sum of the others; at equality it is flat, a rod
    or a point. No tolerance is involved: what is violated by 1e-30 is disproven.

    Raises InvalidInput without python-flint, for robots with loops, wrong shapes, and what is no number; urdf's errors
    for a file that cannot be read.
    """
    source = ExactSource(robot, truth, Reading.of(prove, reading))
    with bits(FIRST_BITS):
        source.at(FIRST_BITS)  # refuses what has no exact values
        at_state = None if q is None else _positions(source, q)
    found = [*_inertias(source), _in_all_poses(source)]
    if at_state is not None:
        found += [_mass_matrix(source, at_state), _constraints(source, at_state), _equations(source, at_state)]
    return tuple(Proof(statement, of, result, reason, source.truth) for statement, of, result, reason in found)


Found = tuple[Statement, str, Result, str]


def _inertias(source: ExactSource) -> Iterator[Found]:
    for name, mass, tensor in source.inertials():
        if mass != 0 or any(x != 0 for row in tensor for x in row):
            yield "a real body can have this inertia", name, *possible_inertia(mass, tensor)


def possible_inertia(mass: Fraction, tensor: Sequence[Sequence[Fraction]]) -> tuple[Result, str]:
    """Whether a real body can have this mass and this tensor (3, 3) about its center of mass: decided, and why.

    The matrix of second moments ½ tr(I) E - I of a real body is positive semidefinite, which says the same as the
    triangle inequalities: the sums of its principal minors are not negative.
    """
    if mass <= 0:
        return "disproven", f"its mass is {'zero, and its tensor is not' if mass == 0 else 'negative'}"
    half_trace = sum((tensor[k][k] for k in range(3)), Fraction(0)) / 2
    second_moments = [[(half_trace if row == k else 0) - tensor[row][k] for k in range(3)] for row in range(3)]
    sums = principal_minor_sums(second_moments)
    if min(sums) < 0:
        excess = least_root([-sums[2], sums[1], -sums[0], Fraction(1)]) * -2
        return "disproven", f"a principal moment exceeds the sum of the others by {decimal(excess, 3)} kg m²"
    if sums[2] > 0:
        return "proven", "each principal moment is less than the sum of the others"
    kind = "flat" if sums[1] > 0 else "a rod" if sums[0] > 0 else "a point"
    return "proven", f"a principal moment is equal to the sum of the others: only of a body that is {kind}"


def principal_minor_sums(matrix: Sequence[Sequence[Fraction]]) -> tuple[Fraction, Fraction, Fraction]:
    """Trace, sum of the principal 2×2 minors, and determinant of a symmetric matrix (3, 3): all are ≥ 0 where it is
    positive semidefinite, and nowhere else."""
    (a, d, e), (_, b, f), (_, _, c) = matrix
    return (
        a + b + c,
        a * b - d * d + a * c - e * e + b * c - f * f,
        a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e),
    )


def _in_all_poses(source: ExactSource) -> Found:
    """The body of the innermost joint that moves has a velocity or turns: its energy is positive, whatever q."""
    statement: Statement = "the mass matrix is positive definite in all poses"
    lacking = [body.name for body in source.model.bodies]
    for precision in _precisions():
        with bits(precision):
            robot = source.at(precision)
            named = zip(source.model.bodies, robot.bodies, strict=True)
            lacking = [
                body.name for body, exact in named if not (exact.mass > 0 and _definite(exact.tensor) == "proven")
            ]
            if not lacking:
                return statement, "", "proven", "each body has a positive mass and a positive definite inertia"
            at_zero = _mass_matrix_in_balls(source, precision, np.zeros(source.model.nv))
            if _definite(at_zero) == "disproven":
                return statement, "", "disproven", f"not at q = 0: {_why_not(source, at_zero)}"
    said = ", ".join(f"'{name}'" for name in lacking)
    return statement, "", "not proven", f"mass and inertia are not proven to be positive of {said}"


def _mass_matrix(source: ExactSource, q: Any) -> Found:
    statement: Statement = "the mass matrix is positive definite at this state"
    for precision in _precisions():
        with bits(precision):
            mass = _mass_matrix_in_balls(source, precision, q)
            result = _definite(mass)
            if result != "not proven":
                reason = "the pivots of its elimination are positive"
                return statement, "", result, reason if result == "proven" else _why_not(source, mass)
    return statement, "", "not proven", f"with {MAX_BITS} bits a pivot of its elimination is not distinct from zero"


def _constraints(source: ExactSource, q: Any) -> Found:
    """φ_q φ_qᵀ is positive definite where the rows of φ_q are independent."""
    statement: Statement = "the constraints have full rank at this state"
    if source.model.couplings:
        return statement, "", "not proven", _COUPLED
    for precision in _precisions():
        with bits(precision):
            n, matrix = source.model.n_bodies, _system(source, precision, q)
            constraints = matrix[BODY_DOF * n :, : BODY_DOF * n]
            if _definite(constraints @ constraints.T) == "proven":
                return statement, "", "proven", f"φ_q φ_qᵀ is positive definite: the rank is {len(constraints)}"
    return statement, "", "not proven", f"φ_q φ_qᵀ is not proven positive definite with {MAX_BITS} bits"


def _equations(source: ExactSource, q: Any) -> Found:
    statement: Statement = "the equations are regular at this state"
    if source.model.couplings:
        return statement, "", "not proven", _COUPLED
    for precision in _precisions():
        with bits(precision):
            matrix = _system(source, precision, q)
            if solved(matrix, zeros(len(matrix))) is not None:
                return statement, "", "proven", f"the matrix of the {len(matrix)} equations has an inverse"
            joint = _without_inertia(source, _mass_matrix_in_balls(source, precision, q))
            if joint is not None:
                return statement, "", "disproven", f"joint '{joint}' moves without inertia"
    return statement, "", "not proven", f"an inverse is not proven with {MAX_BITS} bits"


_COUPLED = "joints drive others; only proven for robots whose joints are independent"


def _definite(matrix: Balls) -> Result:
    """Whether a symmetric matrix is positive definite: by the pivots of its elimination."""
    rest = matrix.copy()
    for k in range(len(rest)):
        pivot = rest[k, k]
        if not pivot > 0:
            return "disproven" if pivot <= 0 else "not proven"
        column = rest[k + 1 :, k] / pivot
        rest[k + 1 :, k + 1 :] = rest[k + 1 :, k + 1 :] - np.outer(column, rest[k, k + 1 :])
    return "proven"


def _mass_matrix_in_balls(source: ExactSource, precision: int, q: Any) -> Balls:
    robot = source.at(precision)
    program = recorded(robot, Request("mass_matrix", ("mass_matrix",)))
    found = evaluate(program.program, {"q": list(as_balls(q)), CONSTANTS: program.constants(robot)})["mass_matrix"]
    return np.array(found, dtype=object).reshape(source.model.nv, source.model.nv)


def _why_not(source: ExactSource, mass: Balls) -> str:
    """Why a mass matrix is not positive definite."""
    joint = _without_inertia(source, mass)
    return "a pivot of its elimination is not positive" if joint is None else f"joint '{joint}' moves without inertia"


def _without_inertia(source: ExactSource, mass: Balls) -> str | None:
    """The name of a joint whose row of the mass matrix is exactly zero."""
    names = zip(source.model.independent_joints, mass, strict=True)
    return next((name for name, row in names if all(x.is_zero() for x in row)), None)


def _system(source: ExactSource, precision: int, q: Any) -> Balls:
    """The matrix of Eq. (111), which velocities and torques do not change."""
    none = list(zeros(source.model.nv))
    return system(source.at(precision), list(as_balls(q)), none, none).matrix


def _positions(source: ExactSource, q: Any) -> Any:
    given = np.asarray(q, dtype=object)
    if given.shape != (source.model.nv,):
        raise InvalidInput(f"q has shape {given.shape}, expected ({source.model.nv},)")
    as_balls(given)
    return given


def _precisions() -> Iterator[int]:
    precision = FIRST_BITS
    while precision < MAX_BITS:
        yield precision
        precision *= 2
    yield MAX_BITS
