"""Where the matrix of Eq. (111) has its entries."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from crosscheck.report.pictures.colors import CURVES, MIDDLE
from crosscheck.report.pictures.svg import picture
from graphdyn.layout import BODY_FREEDOMS, JOINT_CONSTRAINTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = 6.5
"""Width and height of the pattern [inches]."""

MARGIN = 0.07
"""Room for the labels, as a part of the picture."""

FILL = 0.6
"""Height of a label, as a part of the rows of its joint, where 9 points do not fit."""

POINTS = 72
"""Of an inch."""


def matrix_pattern(key: str, pattern: NDArray[np.bool_], n: int) -> Markup:
    """pattern: where the matrix of n bodies has entries (11n, 11n)."""
    size = len(pattern)
    return picture(key, f"Pattern of the {size}×{size} matrix", (SIZE, SIZE), lambda axes: _draw(axes, pattern, n))


def _draw(axes: Axes, pattern: NDArray[np.bool_], n: int) -> None:
    """A square per entry; lines between bodies and joints, their numbers along the left and upper edge."""
    from matplotlib.collections import PolyCollection

    size = len(pattern)
    margin = MARGIN * size
    fontsize = min(9.0, FILL * SIZE * POINTS * JOINT_CONSTRAINTS / (size + margin))
    axes.set_axis_off()
    axes.set(xlim=(-margin, size + 1), ylim=(size + 1, -margin))
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    squares = np.argwhere(pattern)[:, None, ::-1] + corners
    axes.add_collection(PolyCollection(list(squares), facecolor=CURVES[0], linewidth=0))
    starts = [BODY_FREEDOMS * k for k in range(n)] + [BODY_FREEDOMS * n + JOINT_CONSTRAINTS * k for k in range(n + 1)]
    for k, start in enumerate(starts):
        width = 1.2 if k in (0, n, 2 * n) else 0.25
        axes.plot([start, start], [0, size], color=MIDDLE, linewidth=width)
        axes.plot([0, size], [start, start], color=MIDDLE, linewidth=width)
    for k, (start, end) in enumerate(pairwise(starts)):
        label, place = f"{'bj'[k // n]}{k % n + 1}", (start + end) / 2
        axes.annotate(label, (-0.15 * margin, place), fontsize=fontsize, ha="right", va="center")
        axes.annotate(label, (place, -0.15 * margin), fontsize=fontsize, ha="center", va="bottom")
