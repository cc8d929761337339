"""Names, vectors, matrices of 0 and ±1 and powers of ten as text, the same on the terminal and on a page.

Times, and how many times as long something takes, as text.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from graphdyn.errors import counted
from graphdyn.layout import Array

CELL = 3
"""Characters of an entry of a 0/±1 matrix."""

ZERO_COMPONENT_SHARE = 1e-12
"""What is smaller than this part of the largest component is written as 0."""

INVISIBLE_CHARACTERS = re.compile(
    "[\x00-\x1f\x7f-\x9f\xad\u061c\u180e\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ud800-\udfff]"
)
"""Characters that move the cursor, change its direction or cannot be seen, and bytes of file names that are no text."""

_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SIGNS = {0: "·", 1: "1", -1: "−1"}


def printable(text: str, keep: str = "") -> str:
    """Text of others (names, paths, messages) as it may reach a terminal or a page: an escape character as \\x1b.

    keep: characters that stay as they are, such as line breaks
    """
    return INVISIBLE_CHARACTERS.sub(lambda found: found[0] if found[0] in keep else _escape(found[0]), text)


MAX_MESSAGE = 2000
"""Largest number of characters of a message; the parts of a file that it repeats may have any."""


def bounded(message: str) -> str:
    """The message; of a very long one its beginning, which has the place, and its end, which has the remedy."""
    if len(message) <= MAX_MESSAGE:
        return message
    return f"{message[: MAX_MESSAGE // 2]} … {message[-MAX_MESSAGE // 4 :]}"


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode()


def vector_text(values: Sequence[float] | Array) -> str:
    """Components with four digits each."""
    small = ZERO_COMPONENT_SHARE * np.abs(values).max(initial=0.0)
    return " ".join(f"{0.0 if abs(value) <= small else value:.4g}" for value in values)


def matrix_lines(matrix: Sequence[Sequence[int]]) -> list[str]:
    """A matrix of 0 and ±1 with numbered rows and columns, dots for zeros."""
    numbers = range(1, len(matrix[0]) + 1)
    rows = [f"{i:>{CELL}}" + "".join(f"{_SIGNS[x]:>{CELL}}" for x in row) for i, row in enumerate(matrix, start=1)]
    return [" " * CELL + "".join(f"{number:>{CELL}}" for number in numbers), *rows]


def superscript(decade: int) -> str:
    """-3 → 10⁻³."""
    return "10" + str(decade).translate(_SUPERSCRIPT)


DURATION_UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))


UNIT_THRESHOLD = 0.9995
"""Part of a unit from which three digits are those of one whole unit: 1 s, not 1e+03 ms."""


def time_text(seconds: float) -> str:
    """The time with three digits and a unit."""
    size, unit = _unit_for(seconds)
    return f"{seconds / size:.3g} {unit}"


def span_text(spread: tuple[float, float]) -> str:
    """Both in the unit of the larger one."""
    size, unit = _unit_for(spread[1])
    low, high = (f"{x / size:.3g}" for x in spread)
    return f"{low} … {high} {unit}"


def ratio_text(ratio: float) -> str:
    return f"{ratio:.3g}×" if ratio < 999.5 else f"{ratio:.0f}×"


def ratio_span_text(spread: tuple[float, float]) -> str:
    low, high = map(ratio_text, spread)
    return f"{low[:-1]} … {high}"


def threads_text(count: int) -> str:
    return counted(count, "thread")


def _unit_for(seconds: float) -> tuple[float, str]:
    return next(((size, unit) for size, unit in DURATION_UNITS if seconds >= UNIT_THRESHOLD * size), DURATION_UNITS[-1])
