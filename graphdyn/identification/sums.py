"""Linear combinations of parameters in words."""

from collections.abc import Sequence

import numpy as np

from graphdyn.layout import Array

ONE = 1e-9
"""A coefficient this close to 1 is 1; rounding leaves 1e-15, a rounded π/2 in a file 1e-10."""


def sum_in_words(coefficients: Array, names: Sequence[str], *, first: int | None = None) -> str:
    """ "B1 I_yy + 0.25 B2 m": the term `first`, or those with coefficient 1, first; zeros left out."""
    terms = sorted(np.flatnonzero(coefficients), key=lambda k: coefficients[k] != 1.0 if first is None else k != first)
    words = ""
    for k in map(int, terms):
        size = abs(coefficients[k])
        factor = "" if abs(size - 1.0) < ONE else f"{size:.4g} "
        sign = ("-" if coefficients[k] < 0 else "") if not words else (" - " if coefficients[k] < 0 else " + ")
        words += f"{sign}{factor}{names[k]}"
    return words
