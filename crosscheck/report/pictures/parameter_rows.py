"""What pictures with a row for every base parameter have in common: names on the left, a key above."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from crosscheck.report.pictures.svg import INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes

WIDTH, ROW, AXIS = 7.6, 0.165, 0.95
"""Sizes of the picture, of one row, of axis and key [inches]."""

MAX_NAME_CHARACTERS = 30
"""Characters of a name; the table has the whole one."""


def size(count: int) -> tuple[float, float]:
    """Size of a picture with this number of rows [inches]."""
    return WIDTH, ROW * count + AXIS


def put_rows(axes: Axes, names: Sequence[str]) -> None:
    """The rows from the top down, row k at k + 0.5. The horizontal axis has its scale already."""
    count = len(names)
    _, height = size(count)
    axes.set_position((0.3, 0.48 / height, 0.68, ROW * count / height))
    axes.set_facecolor("none")
    axes.spines[:].set_visible(False)
    axes.set(ylim=(count, 0))
    axes.set_yticks(np.arange(count) + 0.5, [_short(name) for name in names], fontsize=8, color=INK)
    axes.tick_params(length=0)


def put_key(axes: Axes, columns: int) -> None:
    axes.legend(
        loc="lower left", bbox_to_anchor=(0, 1.0), ncols=columns, fontsize=8.5, frameon=False, handletextpad=0.4,
        columnspacing=1.4,
    )  # fmt: skip


def _short(name: str) -> str:
    return name if len(name) <= MAX_NAME_CHARACTERS else f"{name[: MAX_NAME_CHARACTERS - 1]}…"
