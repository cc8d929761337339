"""The pattern of the matrix of Eq. (111), drawn with half-block or Braille characters, and as squares of an SVG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from crosscheck.report.pictures.svg import CURVES, MIDDLE_COLOR, picture
from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Pattern = NDArray[np.bool_]

_JOINT_LABEL = "joint 99 "
_BRAILLE_BITS = np.array([[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]])
"""Bit of the dot in each row and column of a Braille character."""

PATTERN_SIZE = 6.5
"""Width and height of the pattern [inches]."""

LABEL_MARGIN = 0.07
"""Room for the labels, as a part of the picture."""

LABEL_FILL = 0.6
"""Height of a label, as a part of the rows of its joint, where 9 points do not fit."""

POINTS_PER_INCH = 72
"""Points of an inch."""


@dataclass(frozen=True)
class Raster:
    """How many entries one character holds, as rows and columns, and how it is drawn."""

    rows: int
    columns: int

    def lines(self, pattern: Pattern) -> list[str]:
        """The pattern as lines of text, filled up with empty rows and columns to whole characters."""
        height, width = pattern.shape
        filled = np.pad(pattern, ((0, -height % self.rows), (0, -width % self.columns)))
        cells = filled.reshape(len(filled) // self.rows, self.rows, -1, self.columns).swapaxes(1, 2)
        return ["".join(self._character(cell) for cell in row) for row in cells]

    def _character(self, cell: Pattern) -> str:
        if self == HALF_BLOCKS:
            return " ▄▀█"[2 * cell[0, 0] + cell[1, 0]]
        dots = sum(int(bit) for bit in _BRAILLE_BITS[cell])
        return chr(0x2800 + dots)


HALF_BLOCKS = Raster(2, 1)
BRAILLE = Raster(4, 2)


def characters(pattern: Pattern, n: int, width: int, chords: Sequence[int] = ()) -> list[str]:
    """[A φ_qᵀ; φ_q 0] of n bodies as lines of at most `width` characters; empty where it cannot fit.

    Bodies are numbered along the upper and left edge of A, joints along those of φ_qᵀ and φ_q. chords: numbers of rows
    of the chords, which are the last ones
    """
    for raster in (HALF_BLOCKS, BRAILLE):
        lines = _framed(pattern, n, raster, chords)
        if len(lines[0]) <= width:
            return lines
    return []


def _framed(pattern: Pattern, n: int, raster: Raster, chords: Sequence[int]) -> list[str]:
    split = BODY_DOF * n
    parts = slice(0, split), slice(split, None)
    (a, phi_t), (phi, zero) = ([raster.lines(pattern[rows, columns]) for columns in parts] for rows in parts)
    margin = " " * len(_JOINT_LABEL)
    bodies = _labels("body", n, BODY_DOF, raster, len(a))
    joints = _labels("joint", n, JOINT_CONSTRAINTS, raster, len(phi))
    first = len(pattern) - split - sum(chords)
    for number, rows in enumerate(chords, start=1):
        joints[first // raster.rows] = f"chord {number}".ljust(len(_JOINT_LABEL))
        first += rows
    numbers = (
        _numbers(n, BODY_DOF, raster, len(a[0])),
        _numbers(n, JOINT_CONSTRAINTS, raster, len(phi_t[0])),
    )
    left, right = ("─" * len(block[0]) for block in (a, phi_t))
    return [
        f"{margin} {' '.join(numbers)} ",
        f"{margin}┌{left}┬{right}┐",
        *_rows(bodies, a, phi_t),
        f"{margin}├{left}┼{right}┤",
        *_rows(joints, phi, zero),
        f"{margin}└{left}┴{right}┘",
    ]


def _rows(labels: Sequence[str], left: Sequence[str], right: Sequence[str]) -> list[str]:
    return [f"{label}│{one}│{two}│" for label, one, two in zip(labels, left, right, strict=True)]


def _labels(what: str, n: int, size: int, raster: Raster, height: int) -> list[str]:
    """A label at the line that holds the first row of each body or joint."""
    labels = [" " * len(_JOINT_LABEL)] * height
    for k in range(n):
        labels[size * k // raster.rows] = f"{what} {k + 1}".ljust(len(_JOINT_LABEL))
    return labels


def _numbers(n: int, size: int, raster: Raster, width: int) -> str:
    """The number of each body or joint above its first column."""
    line = [" "] * width
    for k in range(n):
        for place, digit in enumerate(str(k + 1)):
            line[size * k // raster.columns + place] = digit
    return "".join(line)


def squares(key: str, pattern: Pattern, n: int, chords: Sequence[int] = ()) -> Markup:
    """The same as squares, for a page. key: as Picture.draw has it; the others as those of `characters`"""
    size = len(pattern)
    label = f"Pattern of the {size}×{size} matrix"
    return picture(key, label, (PATTERN_SIZE, PATTERN_SIZE), lambda axes: _draw(axes, pattern, n, chords))


def _draw(axes: Axes, pattern: Pattern, n: int, chords: Sequence[int]) -> None:
    """A square per entry; lines between bodies and joints, their numbers along the left and upper edge."""
    from matplotlib.collections import PolyCollection

    size = len(pattern)
    margin = LABEL_MARGIN * size
    fontsize = min(9.0, LABEL_FILL * PATTERN_SIZE * POINTS_PER_INCH * JOINT_CONSTRAINTS / (size + margin))
    axes.set_axis_off()
    axes.set(xlim=(-margin, size + 1), ylim=(size + 1, -margin))
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    places = np.argwhere(pattern)[:, None, ::-1] + corners
    axes.add_collection(PolyCollection(list(places), facecolor=CURVES[0], linewidth=0))
    # couplings, a row each, stand between joints and chords without a label
    ends = np.cumsum([0, *n * [BODY_DOF], *n * [JOINT_CONSTRAINTS]]).tolist()
    of_chords = (size - sum(chords) + np.cumsum([0, *chords])).tolist()
    for k, start in enumerate([*ends, *of_chords]):
        width = 1.2 if k in (0, n, 2 * n) or start == size else 0.25
        axes.plot([start, start], [0, size], color=MIDDLE_COLOR, linewidth=width)
        axes.plot([0, size], [start, start], color=MIDDLE_COLOR, linewidth=width)
    numbers = {"b": n, "j": n, "c": len(chords)}
    names = [f"{letter}{k}" for letter, number in numbers.items() for k in range(1, number + 1)]
    for label, (start, end) in zip(names, [*pairwise(ends), *pairwise(of_chords)], strict=True):
        place = (start + end) / 2
        axes.annotate(label, (-0.15 * margin, place), fontsize=fontsize, ha="right", va="center")
        axes.annotate(label, (place, -0.15 * margin), fontsize=fontsize, ha="center", va="bottom")
