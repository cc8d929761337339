"""Pattern of the entries of the matrix of Eq. (111)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from crosscheck.report.pictures.colors import CURVES, MIDDLE_COLOR
from crosscheck.report.pictures.svg import picture
from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PATTERN_SIZE = 6.5
"""Width and height of the pattern [inches]."""

LABEL_MARGIN = 0.07
"""Room for the labels, as a part of the picture."""

LABEL_FILL = 0.6
"""Height of a label, as a part of the rows of its joint, where 9 points do not fit."""

POINTS_PER_INCH = 72
"""Points of an inch."""


def matrix_pattern(key: str, pattern: NDArray[np.bool_], n: int, chords: Sequence[int] = ()) -> Markup:
    """pattern: where the matrix of n bodies has entries; chords: numbers of rows of the chords, which are the last."""
    size = len(pattern)
    label = f"Pattern of the {size}×{size} matrix"
    return picture(key, label, (PATTERN_SIZE, PATTERN_SIZE), lambda axes: _draw(axes, pattern, n, chords))


def _draw(axes: Axes, pattern: NDArray[np.bool_], n: int, chords: Sequence[int]) -> None:
    """A square per entry; lines between bodies and joints, their numbers along the left and upper edge."""
    from matplotlib.collections import PolyCollection

    size = len(pattern)
    margin = LABEL_MARGIN * size
    fontsize = min(9.0, LABEL_FILL * PATTERN_SIZE * POINTS_PER_INCH * JOINT_CONSTRAINTS / (size + margin))
    axes.set_axis_off()
    axes.set(xlim=(-margin, size + 1), ylim=(size + 1, -margin))
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    squares = np.argwhere(pattern)[:, None, ::-1] + corners
    axes.add_collection(PolyCollection(list(squares), facecolor=CURVES[0], linewidth=0))
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
