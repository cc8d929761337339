"""The page of one robot: `graphdyn show` with pictures."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crosscheck.report.comparisons import versions
from crosscheck.report.pages.rendering import render
from crosscheck.report.pages.stick_figure import pose_text, stick_figure
from crosscheck.report.pages.svg import picture
from crosscheck.report.plain_text import matrix_lines, vector_text
from crosscheck.studies.description import RobotDescription, SystemRecord
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

ENTRY, LINE = "#14507f", "#8a8f96"


def show_page(robot: RobotDescription, command: Sequence[str]) -> str:
    """The page of one robot. The same arguments and versions give the same characters."""
    name, system = Path(robot.robot).name, robot.system
    size = len(system.pattern)
    return render(
        "show.html",
        robot=robot,
        name=name,
        inside=[joint.inside for joint in robot.model.joints],
        matrices={title: "\n".join(matrix_lines(matrix)) for title, matrix in robot.graph.matrices.items()},
        entries=[(int(i), int(j)) for i, j in np.argwhere(robot.graph.incidence)],
        size=size,
        nonzero=int(system.pattern.sum()),
        pose=pose_text(robot.model),
        figure=stick_figure("figure", robot.model, name),
        pattern=picture(
            "pattern", f"Pattern of the {size}×{size} matrix", (SIZE, SIZE), lambda axes: _draw(axes, system)
        ),
        vector=vector_text,
        command=shlex.join(command),
        versions=versions(),
    )


def _draw(axes: Axes, system: SystemRecord) -> None:
    """A square per entry; lines between bodies and joints, their numbers along the left and upper edge."""
    from matplotlib.collections import PolyCollection

    n, size = system.n_bodies, len(system.pattern)
    margin = MARGIN * size
    fontsize = min(9.0, FILL * SIZE * POINTS * JOINT_CONSTRAINTS / (size + margin))
    axes.set_axis_off()
    axes.set(xlim=(-margin, size + 1), ylim=(size + 1, -margin))
    corners = np.array([[0, 0], [1, 0], [1, 1], [0, 1]])
    squares = np.argwhere(system.pattern)[:, None, ::-1] + corners
    axes.add_collection(PolyCollection(list(squares), facecolor=ENTRY, linewidth=0))
    starts = [BODY_FREEDOMS * k for k in range(n)] + [BODY_FREEDOMS * n + JOINT_CONSTRAINTS * k for k in range(n + 1)]
    for k, start in enumerate(starts):
        width = 1.2 if k in (0, n, 2 * n) else 0.25
        axes.plot([start, start], [0, size], color=LINE, linewidth=width)
        axes.plot([0, size], [start, start], color=LINE, linewidth=width)
    for k, (start, end) in enumerate(pairwise(starts)):
        label, place = f"{'bj'[k // n]}{k % n + 1}", (start + end) / 2
        axes.annotate(label, (-0.15 * margin, place), fontsize=fontsize, ha="right", va="center")
        axes.annotate(label, (place, -0.15 * margin), fontsize=fontsize, ha="center", va="bottom")
