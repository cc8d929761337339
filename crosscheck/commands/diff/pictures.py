"""Both robots drawn one over the other, and what differs between their torques as bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.report.pictures.stick_figure import two_stick_figures
from crosscheck.report.pictures.svg import BAR, CURVES, picture
from crosscheck.report.report import Picture
from graphdyn.aligning import ModelDifferences
from graphdyn.model import unit_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TERM_COLORS = {"gravity": CURVES[0], "inertia": CURVES[2], "velocity": CURVES[3]}

SIZE = (6.4, 2.8)
"""Width and height of the bars [inches]."""


def overlay_picture(found: ModelDifferences) -> Picture:
    """A, and B as it is laid over A."""

    def draw(key: str) -> Markup:
        return two_stick_figures(key, found.alignment.first, found.alignment.model)

    return Picture(draw, "A at zero, and B over it, dashed in red.", wide=False, on=("page",))


def torque_bars(found: ModelDifferences) -> Picture:
    """The largest difference of every term, joint by joint."""
    names = found.alignment.first.joint_names
    unit = unit_of(found.alignment.first.joints, "N m", "N")
    terms = list(TERM_COLORS)

    def bars(axes: Axes) -> None:
        axes.set_position((0.1, 0.16, 0.88, 0.74))
        width = 0.8 / len(terms)
        for k, term in enumerate(terms):
            heights = [abs(one.difference) for one in found.torques if one.term == term]
            places = np.arange(len(names)) + (k - 1) * width
            axes.bar(places, heights, width, color=TERM_COLORS[term], label=term)
        axes.set_xticks(range(len(names)), [str(k) for k in range(1, len(names) + 1)])
        axes.set(xlabel="joint", ylabel=f"|B − A| [{unit}]")
        axes.legend(frameon=False)
        axes.spines[["top", "right"]].set_visible(False)
        axes.spines[["left", "bottom"]].set_color(BAR)

    def draw(key: str) -> Markup:
        return picture(key, f"Largest differences of torque [{unit}] by joint and term", SIZE, bars)

    return Picture(draw, "The largest difference of each term of the torque, by joint.", on=("page",))
