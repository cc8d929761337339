"""The two kinds of numbers that compiled programs compute with, and what their sine and cosine take.

Reduction to [-π/4, π/4] by Cody and Waite with π/2 in three parts. In double precision these have 33 bits, and their
products with the number of quarter turns are exact up to max_angle; the polynomials are the minimax ones of FreeBSD's
msun (k_sin.c, k_cos.c; Sun Microsystems, 1993). In single precision the parts have all 24 bits, and a product and a
difference are rounded once together, the first time to nothing; the polynomials are minimax too (Remez).
Measured against fifty digits, in units in the last place: double within 1.4 up to 100 rad, 2.3 up to max_angle; single
within 1.6 up to max_angle. Neighbors of the multiples of π/2 are included.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.errors import InvalidInput

QUARTER_TURNS_PER_RADIAN = 0.6366197723675814  # 2 / π


@dataclass(frozen=True)
class Precision:
    """A kind of numbers.

    real, integer: types of LLVM; bits: of both
    dtype: the type of arrays
    max_angle: largest |angle| [rad] that is reduced without loss
    rounding_offset: one and a half times what has no bits for fractions: adding it leaves the nearest integer in the
        last bits of the sum
    half_pi: parts of π/2; exact_products: whether those with numbers of quarter turns are exact
    sine_coefficients: of sin r = r + r r² (s_1 + s_2 r² + …)
    cosine_coefficients: of cos r = 1 - r²/2 + r⁴ (c_1 + c_2 r² + …)
    min_pivot_share: a pivot below this part of what the inertia about its joint can be: the mass matrix may be singular
    """

    real: str
    integer: str
    bits: int
    dtype: np.dtype[Any]
    max_angle: float
    rounding_offset: float
    half_pi: tuple[float, ...]
    exact_products: bool
    sine_coefficients: tuple[float, ...]
    cosine_coefficients: tuple[float, ...]
    min_pivot_share: float

    @property
    def bytes(self) -> int:
        """Bytes of a number."""
        return self.bits // 8


DOUBLE = Precision(
    real="double",
    integer="i64",
    bits=64,
    dtype=np.dtype(np.float64),
    max_angle=1e6,  # 2/π of it stays below 2^20 = 53 - 33 bits
    rounding_offset=1.5 * 2.0**52,
    half_pi=(1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21),
    exact_products=True,
    sine_coefficients=(
        -1.66666666666666324348e-01,
        8.33333333332248946124e-03,
        -1.98412698298579493134e-04,
        2.75573137070700676789e-06,
        -2.50507602534068634195e-08,
        1.58969099521155010221e-10,
    ),
    cosine_coefficients=(
        4.16666666666666019037e-02,
        -1.38888888888741095749e-03,
        2.48015872894767294178e-05,
        -2.75573143513906633035e-07,
        2.08757232129817482790e-09,
        -1.13596475577881948265e-11,
    ),
    min_pivot_share=1e-9,  # six digits more cautious than the test that decides (graphdyn.equations.projected.singular)
)

SINGLE = Precision(
    real="float",
    integer="i32",
    bits=32,
    dtype=np.dtype(np.float32),
    max_angle=1e5,  # rounding 2/π of it costs a hundredth of a quarter turn, for which the polynomials have room
    rounding_offset=1.5 * 2.0**23,
    half_pi=(1.5707963705062866, -4.371138828673793e-08, -1.7151245100058819e-15),
    exact_products=False,
    sine_coefficients=(-0.16666653752326965, 0.008332083001732826, -0.00019504317606333643),
    cosine_coefficients=(0.04166664555668831, -0.0013887243112549186, 2.4423889044555835e-05),
    min_pivot_share=1e-4,  # a pivot's rounding is some 1e-7 of its scale
)


def precision_of(dtype: object) -> Precision:
    """The kind of an array's type. Raises InvalidInput for any other type."""
    for precision in (DOUBLE, SINGLE):
        try:
            if dtype is not None and np.dtype(dtype) == precision.dtype:  # type: ignore[call-overload]
                return precision
        except TypeError:
            break
    raise InvalidInput(f"dtype is {dtype!r}; give numpy.float64 or numpy.float32")
