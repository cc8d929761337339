"""Balls: numbers as intervals that provably hold the true value (python-flint, that is Arb), and what they tell.

All arrays are NumPy arrays of balls, so that +, @ and slices mean what they mean elsewhere. The precision is that of
the innermost `bits`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from contextlib import AbstractContextManager
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from graphdyn import InvalidInput
from graphdyn.errors import not_installed
from urdf.document import NUMBER

Ball = Any
"""A flint.arb."""

Balls = NDArray[np.object_]

_TIMES_PI = re.compile(r"([+-]?)(?:([0-9.]+(?:/[0-9]+)?)\s*\*?\s*)?(?:pi|π)(?:\s*/\s*([0-9.]+))?")
"""3pi/4, -pi, 0.5*pi, 2/3 π"""

_DECIMAL = re.compile(NUMBER)


def bits(precision: int) -> AbstractContextManager[Any]:
    """Inside, balls are rounded to so many bits. Raises InvalidInput where python-flint is missing."""
    check_installed()
    from flint import ctx

    found: AbstractContextManager[Any] = ctx.workprec(precision)
    return found


def check_installed() -> None:
    """Raises InvalidInput where python-flint is missing."""
    try:
        import flint  # noqa: F401
    except ImportError as error:
        raise InvalidInput(f"exact values: {not_installed('python-flint', 'exact')}") from error


def ball(number: object) -> Ball:
    """The ball of a double, an integer, a fraction, or a text: a decimal, a fraction, or a multiple of π, as -3pi/4.

    Doubles and integers are exact, and so are fractions whose denominator is a power of two. Raises InvalidInput for
    anything else.
    """
    from flint import arb, fmpq

    if isinstance(number, arb):
        return number
    if isinstance(number, str):
        return _ball_of_text(number)
    if isinstance(number, Fraction):
        return arb(fmpq(number.numerator, number.denominator))
    if isinstance(number, int | np.integer):
        return arb(int(number))
    if isinstance(number, float | np.floating) and np.isfinite(number):
        return arb(float(number))
    raise InvalidInput(f"{number!r} is no finite number; give doubles, fractions, or texts as '0.3', '2/3', 'pi/2'")


def _ball_of_text(text: str) -> Ball:
    from flint import arb

    try:
        if found := _TIMES_PI.fullmatch(text.strip()):
            sign, factor, divisor = found.groups()
            share = Fraction(factor or 1) / Fraction(divisor or 1)
            return arb.pi() * ball(-share if sign == "-" else share)
        if _DECIMAL.fullmatch(text):  # of any length, which Fraction refuses
            return arb(text)
        return ball(Fraction(text.strip()))
    except (ValueError, ZeroDivisionError):
        raise InvalidInput(
            f"'{text}' is no number; give a decimal, a fraction, or a multiple of π as '-3pi/4'"
        ) from None


def as_balls(values: Any) -> Balls:
    """An array of balls of the same shape. Raises InvalidInput for what is no number."""
    given = np.asarray(values, dtype=object)
    made = np.empty(given.shape, dtype=object)
    made.ravel()[:] = [ball(x) for x in given.ravel()]
    return made


def zeros(*shape: int) -> Balls:
    return np.full(shape, ball(0), dtype=object)


def eye() -> Balls:
    unit = zeros(3, 3)
    unit[np.diag_indices(3)] = ball(1)
    return unit


def norm(vector: Balls) -> Ball:
    return (vector @ vector).sqrt()


def cross(x: Balls, y: Balls) -> Balls:
    return np.array([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]], dtype=object)


def rotation_about(axis: Balls, angle: Ball) -> Balls:
    """Rotation (3, 3) by an angle about a unit axis (Rodrigues)."""
    x, y, z = axis
    zero, c, s = ball(0), angle.cos(), angle.sin()
    across = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]], dtype=object)
    turned: Balls = eye() * c + across * s + np.outer(axis, axis) * (1 - c)
    return turned


def nearest_rotation(matrix: Balls) -> Balls:
    """The orthogonal polar factor (3, 3) of a matrix that is a rotation up to rounding: the rotation nearest to it.

    X (3 E - XᵀX) / 2 has the polar factor of X, and |XᵀX - E| falls quadratically. No entry is farther from the polar
    factor than that: |σ - 1| ≤ |σ² - 1| for the singular values σ of X.
    """
    from flint import arb

    half, before = ball(0.5), ball(1)
    while True:
        defect = matrix.T @ matrix - eye()
        size = sum((x.abs_upper() for x in defect.ravel()), ball(0)).abs_upper()  # at least the Frobenius norm
        if size == 0:
            return matrix
        if not size < before * half:
            around: Balls = np.full((3, 3), arb(0, size), dtype=object)
            return np.add(matrix, around)
        matrix, before = matrix @ (eye() - defect * half), size


def radius(values: Balls) -> float:
    """The largest radius, rounded up."""
    return _up(max((x.rad() for x in values.ravel()), default=ball(0)))


def magnitude(values: Balls) -> float:
    """The largest absolute value, rounded up."""
    return _up(max((x.abs_upper() for x in values.ravel()), default=ball(0)))


def _up(x: Ball) -> float:
    """A double that is not below x."""
    nearest = float(x.mid())
    return nearest if x <= nearest else float(np.nextafter(nearest, np.inf))


def is_finite(values: Balls) -> bool:
    """Whether every ball is bounded."""
    return all(x.is_finite() for x in values.ravel())


def rounded(x: Ball) -> float | None:
    """The double nearest to the true value, or None where the ball does not tell."""
    lower, upper = nearest_double(x.lower()), nearest_double(x.upper())
    return lower if lower == upper else None


def nearest_double(x: Ball) -> float:
    """The double nearest to the middle of a ball."""
    return float(x.mid())


def decimal(x: Ball, digits: int) -> str:
    """The value with so many significant digits, or fewer: only those that are proven, the last up to one unit."""
    return str(x.str(digits, radius=False))


def least_root(coefficients: Sequence[Fraction]) -> Ball:
    """The least root of a polynomial whose roots are real. coefficients: of ascending powers"""
    from flint import fmpq, fmpq_poly

    polynomial = fmpq_poly([fmpq(x.numerator, x.denominator) for x in coefficients])
    roots: Any = polynomial.complex_roots()
    return min((root.real for root, _ in roots), key=nearest_double)


def solved(matrix: Balls, rhs: Balls) -> Balls | None:
    """x (n,) with matrix (n, n) times x = rhs (n,); None where the balls do not prove that there is exactly one."""
    from flint import arb_mat

    size = len(rhs)
    try:
        found = arb_mat(size, size, list(matrix.ravel())).solve(arb_mat(size, 1, list(rhs)))
    except ZeroDivisionError:
        return None
    return np.array(found.entries(), dtype=object)
