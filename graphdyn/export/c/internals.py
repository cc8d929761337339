"""The header that the functions of one robot share and their users do not see: rows and lanes, sine and cosine."""

from __future__ import annotations

from collections.abc import Sequence

from graphdyn.compiler.llvm.precision import DOUBLE, QUARTER_TURNS_PER_RADIAN
from graphdyn.export.c.dialect import Dialect
from graphdyn.export.c.identifiers import comment

_HEAD = """#ifndef @NAME@_INTERNAL_H
#define @NAME@_INTERNAL_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "@name@.h"

/* The arrays of a call do not overlap. */
#if defined(__GNUC__) || defined(__clang__) || defined(_MSC_VER)
#define RESTRICT __restrict
#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 199901L
#define RESTRICT restrict
#else
#define RESTRICT
#endif

/* Rows that a batch computes at once. */
enum { @NAME@_LANES = @lanes@ };

/* Rows of a width as columns of lanes. The last row is there again in lanes for which there is none. */
static inline void @name@_gather(const @real@ *rows, size_t count, size_t width, @real@ *columns)
{
    if (count == @NAME@_LANES)
        for (size_t k = 0; k < width; ++k)
            for (size_t lane = 0; lane < @NAME@_LANES; ++lane)
                columns[k * @NAME@_LANES + lane] = rows[width * lane + k];
    else
        for (size_t k = 0; k < width; ++k)
            for (size_t lane = 0; lane < @NAME@_LANES; ++lane)
                columns[k * @NAME@_LANES + lane] = rows[width * (lane < count ? lane : count - 1) + k];
}

/* The other way round, for the lanes that there are rows for. */
static inline void @name@_scatter(const @real@ *columns, size_t count, size_t width, @real@ *rows)
{
    if (count == @NAME@_LANES)
        for (size_t lane = 0; lane < @NAME@_LANES; ++lane)
            for (size_t k = 0; k < width; ++k)
                rows[width * lane + k] = columns[k * @NAME@_LANES + lane];
    else
        for (size_t lane = 0; lane < count; ++lane)
            for (size_t k = 0; k < width; ++k)
                rows[width * lane + k] = columns[k * @NAME@_LANES + lane];
}

/* Of each lane, the smallest pivot as a share of what the inertia about its joint can be. */
static inline int @name@_pivots(int count, const @real@ *pivot)
{
    int small = 0;
    for (int k = 0; k < count; ++k)
        small |= pivot[k] < @least@;
    return small ? @NAME@_SINGULAR : @NAME@_OK;
}
"""

_LIBM = """static inline int @name@_turns(int count, const @real@ *angle, @real@ *sine, @real@ *cosine)
{
    for (int k = 0; k < count; ++k) {
        sine[k] = @sin@(angle[k]);
        cosine[k] = @cos@(angle[k]);
    }
    return @NAME@_OK;
}
"""

_OWN = """#if defined(__FAST_MATH__)
#error "compile without -ffast-math, which takes sums apart that sine and cosine need as they stand"
#endif
#if defined(FLT_EVAL_METHOD) && (FLT_EVAL_METHOD == 2 || FLT_EVAL_METHOD == -1)
#error "sine and cosine need numbers of 53 bits: compile with -msse2 -mfpmath=sse"
#endif

/* Sine and cosine without branches: the angle less the nearest multiple k of pi/2, in three parts whose products with k
 * are exact; polynomials; and the quadrant from the last bits of k + 1.5 * 2^52.
 */
static inline void @name@_turn(double angle, double *sine, double *cosine)
{
    const double scaled = angle * @quarter@ + @offset@;
    const double k = scaled - @offset@;
    const double r = ((angle - k * @half0@) - k * @half1@) - k * @half2@;
    const double z = r * r;
    const double s = @sine@;
    const double c = @cosine@;
    const uint64_t sign = UINT64_C(1) << 63;
    uint64_t quadrant, s_bits, c_bits, odd, sine_bits, cosine_bits;
    memcpy(&quadrant, &scaled, sizeof quadrant);
    memcpy(&s_bits, &s, sizeof s_bits);
    memcpy(&c_bits, &c, sizeof c_bits);
    odd = UINT64_C(0) - (quadrant & 1);
    sine_bits = ((s_bits & ~odd) | (c_bits & odd)) ^ ((quadrant << 62) & sign);
    cosine_bits = ((c_bits & ~odd) | (s_bits & odd)) ^ (((quadrant + 1) << 62) & sign);
    memcpy(sine, &sine_bits, sizeof sine_bits);
    memcpy(cosine, &cosine_bits, sizeof cosine_bits);
}

static inline int @name@_turns(int count, const @real@ *angle, @real@ *sine, @real@ *cosine)
{
    int far = 0;
    for (int k = 0; k < count; ++k) {
        double s, c;
        @name@_turn(angle[k], &s, &c);
        sine[k] = @cast@s;
        cosine[k] = @cast@c;
    }
    for (int k = 0; k < count; ++k)
        far |= !(angle[k] * angle[k] <= @largest@);
    return far ? @NAME@_FAR_ANGLE : @NAME@_OK;
}
"""


def internal_header(dialect: Dialect) -> str:
    """NAME_internal.h."""
    double = dialect.precision == "double"
    parts = [
        comment([f"What the functions of {dialect.name} share. Not for their users."]) + "\n" + _HEAD,
        _OWN if dialect.sines == "own" else _LIBM,
        "#endif\n",
    ]
    return dialect.filled(
        "\n".join(parts),
        lanes=dialect.lanes,
        sin="sin" if double else "sinf",
        cos="cos" if double else "cosf",
        cast="" if double else "(float) ",
        quarter=repr(QUARTER_TURNS_PER_RADIAN),
        offset=repr(DOUBLE.rounding_offset),
        sine=f"r + r * z * {_horner(DOUBLE.sine_coefficients, 'z')}",
        cosine=_horner((1.0, -0.5, *DOUBLE.cosine_coefficients), "z"),
        least=dialect.literal(DOUBLE.min_pivot_share),
        largest=dialect.literal(DOUBLE.max_angle**2),
        **{f"half{k}": repr(part) for k, part in enumerate(DOUBLE.half_pi)},
    )


def _horner(coefficients: Sequence[float], x: str) -> str:
    text = repr(coefficients[-1])
    for coefficient in reversed(coefficients[:-1]):
        text = f"({coefficient!r} + {x} * {text})"
    return text
