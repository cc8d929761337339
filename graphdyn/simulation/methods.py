"""Explicit Runge-Kutta methods of fixed step: their coefficients.

"euler": explicit Euler. "rk4": Kutta's classical method of order 4. "rk8": the method of order 8, twelve stages, of
Dormand and Prince that DOP853 is made of (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section
II.5); its coefficients are those of scipy.integrate.DOP853.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from graphdyn.layout import Array

FIXED_STEPS = ("rk8", "rk4", "euler")


@dataclass(frozen=True, eq=False)
class Tableau:
    """a (s, s), b (s,) and c (s,) of Butcher's table."""

    a: Array
    b: Array
    c: Array


@cache
def tableau(name: str) -> Tableau:
    """One of FIXED_STEPS."""
    if name == "euler":
        return Tableau(np.zeros((1, 1)), np.ones(1), np.zeros(1))
    if name == "rk4":
        a = np.zeros((4, 4))
        a[1, 0], a[2, 1], a[3, 2] = 0.5, 0.5, 1.0
        return Tableau(a, np.array([1.0, 2.0, 2.0, 1.0]) / 6, np.array([0.0, 0.5, 0.5, 1.0]))
    from scipy.integrate import DOP853

    s = DOP853.n_stages
    return Tableau(DOP853.A[:s, :s], DOP853.B, DOP853.C[:s])
