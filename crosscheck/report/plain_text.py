"""Vectors, matrices of 0 and ±1 and powers of ten as text, the same on the terminal and on a page."""

from collections.abc import Sequence

import numpy as np

CELL = 3
"""Characters of an entry of a 0/±1 matrix."""

ROUNDING = 1e-12
"""What is smaller than this part of the largest component is written as 0."""

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SIGNS = {0: "·", 1: "1", -1: "−1"}


def vector_text(values: Sequence[float]) -> str:
    """Components with four digits each."""
    small = ROUNDING * np.abs(values).max(initial=0.0)
    return " ".join(f"{0.0 if abs(value) <= small else value:.4g}" for value in values)


def matrix_lines(matrix: Sequence[Sequence[int]]) -> list[str]:
    """A matrix of 0 and ±1 with numbered rows and columns, dots for zeros."""
    numbers = range(1, len(matrix[0]) + 1)
    rows = [f"{i:>{CELL}}" + "".join(f"{_SIGNS[x]:>{CELL}}" for x in row) for i, row in enumerate(matrix, start=1)]
    return [" " * CELL + "".join(f"{number:>{CELL}}" for number in numbers), *rows]


def superscript(decade: int) -> str:
    """-3 → 10⁻³."""
    return "10" + str(decade).translate(_SUPERSCRIPT)
