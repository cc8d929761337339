"""`graphdyn paper`: the tables and results of the paper beside the corrected model, as a report.

The paper's arm is drawn as cylinders on its rail, with body frames and joint axes: Figures 2, 10 and 11.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup

from crosscheck.commands.errata.report import MEANINGS, distributions, effects_table, missing_rank, towards_lock
from crosscheck.commands.paper.identification_report import BODY_TABLE_COLUMNS, identification_section
from crosscheck.commands.paper.multipliers_report import corrected_section, over_time_section, printed_section
from crosscheck.commands.paper.record import record
from crosscheck.paper.printed import POSE_TIMES
from crosscheck.paper.reproduction import EXPERIMENT_NOTE, WHY_ERRATA, Check, Reproduction
from crosscheck.paper.tables import WHY_TABLE_2, GeometryTable, joint_motion, rail
from crosscheck.report.pictures import svg as colors
from crosscheck.report.pictures.stick_figure import AZIMUTH, ELEVATION, FAINT, GROUND, JOINT, LINK
from crosscheck.report.pictures.svg import CURVES, INK, picture
from crosscheck.report.report import (
    WIDE_LINE_CHARACTERS,
    Block,
    Column,
    Picture,
    Prose,
    Report,
    Row,
    Section,
    Table,
    Verdict,
)
from graphdyn import MaximalState, kr500, maximal_state
from graphdyn.equations import joint_axes, link_origins
from graphdyn.experiments import BODY_LENGTHS, BODY_RADII
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


POSE_PICTURE_SIZE = 3.7
"""Width and height of a picture [inches]."""

PICTURE_RANGE = ((-2.3, 2.1), (-0.9, 3.5))
"""Range of the picture's plane, around the base: the arm in all three poses [m]."""

FRAME, AXIS, RAIL = 0.36, 0.75, 2.4
"""Lengths of the body axes, half lengths of the joint axes and of the drawn part of the rail [m]."""

LABEL_DISTANCE_POINTS = 11.0
"""Distance of a joint's name from its origin, against e_3 of its body [points]."""

CIRCLE_ANGLES = np.linspace(0.0, 2 * np.pi, 33)

FRAME_STYLES = ((CURVES[0], "-", "e_1"), (CURVES[1], (0, (3, 1.2)), "e_2"), (CURVES[2], (0, (1, 1)), "e_3"))
"""Color and line of e_1, e_2, e_3."""

_TOWARD = np.array([np.cos(AZIMUTH) * np.cos(ELEVATION), np.sin(AZIMUTH) * np.cos(ELEVATION), np.sin(ELEVATION)])
_RIGHT = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
_VIEW = np.stack([_RIGHT, np.cross(_TOWARD, _RIGHT)])
"""Right and up of the picture."""


def arm_pose(key: str, title: str, q: Array, travel: float) -> Markup:
    """The arm at joint positions q (6,) [rad], its carriage so far along the rail [m]."""
    state = maximal_state(kr500(), q)
    turned = ", ".join(f"joint {j} at {np.rad2deg(x):.5g}°" for j, x in enumerate(q, start=1) if x)
    label = f"{title}: the KR500 as six cylinders on a rail, {turned or 'all joints at 0°'}, carriage at {travel:.3g} m"
    return picture(key, label, (POSE_PICTURE_SIZE, POSE_PICTURE_SIZE), lambda axes: _draw(axes, state, travel))


def _draw(axes: Axes, state: MaximalState, travel: float) -> None:
    axes.set_axis_off()
    axes.set(xlim=PICTURE_RANGE[0], ylim=PICTURE_RANGE[1])
    _draw_rail(axes, travel)
    origins, directions = link_origins(state), joint_axes(state)
    middle = origins + state.rotation[:, :, 0] * np.array(BODY_LENGTHS)[:, None] / 2
    for i in np.argsort(middle @ _TOWARD):  # the nearest last
        _draw_cylinder(axes, origins[i], state.rotation[i], BODY_LENGTHS[i], BODY_RADII[i])
    for origin, direction, rotation in zip(origins, directions, state.rotation, strict=True):
        ends = origin + AXIS * np.array([[-1.0], [1.0]]) * direction
        axes.plot(*_flat(ends), color=JOINT, linewidth=1, linestyle=(0, (7, 2, 1.5, 2)), zorder=20)
        for column, (color, style, _) in enumerate(FRAME_STYLES):
            tip = origin + FRAME * rotation[:, column]
            axes.plot(*_flat(np.array([origin, tip])), color=color, linewidth=1.5, linestyle=style, zorder=21)
            axes.plot(*_flat(tip[None]), marker="o", markersize=2.2, color=color, zorder=21)
    for j, origin in enumerate(origins, start=1):
        place = _flat(origin[None])[:, 0]
        axes.plot(*place, marker="o", markersize=4.5, color="white", mec=JOINT, mew=1.2, zorder=22)
        away = -_flat(state.rotation[j - 1, None, :, 2])[:, 0]
        axes.annotate(
            f"O{j}", tuple(place), xytext=tuple(LABEL_DISTANCE_POINTS * away / np.linalg.norm(away)),
            textcoords="offset points", fontsize=7.5, color=INK, ha="center", va="center", zorder=23,
        )  # fmt: skip


def _draw_rail(axes: Axes, travel: float) -> None:
    """The rail along world x under the carriage, and how far the carriage has come."""
    for side in (-0.35, 0.35):
        line = np.array([[-RAIL, side, 0.0], [RAIL, side, 0.0]])
        axes.plot(*_flat(line), color=GROUND, linewidth=3, solid_capstyle="round", zorder=0)
    end = _flat(np.array([[1.5, -0.9, 0.0]]))[:, 0]
    axes.annotate(f"rail, x = {travel:.4g} m", tuple(end), fontsize=8, color=LINK, ha="center", zorder=1)
    for direction, letter in zip(np.eye(3), "xyz", strict=True):
        start = np.array([-1.5, -0.6, 0.0])
        axes.plot(*_flat(np.array([start, start + 0.4 * direction])), color=FAINT, linewidth=1, zorder=1)
        place = _flat((start + 0.55 * direction)[None])[:, 0]
        axes.annotate(letter, tuple(place), fontsize=8, color=LINK, ha="center", va="center", zorder=1)


def _draw_cylinder(axes: Axes, origin: Array, rotation: Array, length: float, radius: float) -> None:
    """Its outline, and the outer end where the viewer sees it."""
    from scipy.spatial import ConvexHull

    ring = radius * (np.cos(CIRCLE_ANGLES)[:, None] * rotation[:, 1] + np.sin(CIRCLE_ANGLES)[:, None] * rotation[:, 2])
    near = origin if rotation[:, 0] @ _TOWARD < 0 else origin + length * rotation[:, 0]
    far = 2 * origin + length * rotation[:, 0] - near
    points = np.hstack([_flat(near + ring), _flat(far + ring)]).T
    outline = points[ConvexHull(points).vertices]
    axes.fill(*outline.T, facecolor=colors.GROUND, edgecolor=LINK, linewidth=0.9, zorder=5)
    axes.fill(*_flat(near + ring), facecolor=colors.FAINT_COLOR, edgecolor=LINK, linewidth=0.6, zorder=5)


def _flat(points: Array) -> Array:
    """Orthographic projection (k, 3) → (2, k)."""
    return _VIEW @ points.T


REFERENCE_NOTE = "Pinocchio is the judge. Labels such as B5 are the numbers of docs/deviations.md."
BODY_AXES_NOTE = (
    "At every joint ○ O1 … O6: the body axes e_1 (full), e_2 (dashed), e_3 (dotted), and the joint axis (dash-dotted)."
)


def paper_report(found: Reproduction) -> Report:
    return Report(
        "The paper beside the corrected model",
        _verdict(found.checks),
        (
            Section("holds", "What holds", (_checks(found.checks),)),
            Section("table-2", "Table 2: geometry and density", (Prose(WHY_TABLE_2), _geometry(found.geometry))),
            Section("experiment", "The experiment of section 3.1", (Prose(EXPERIMENT_NOTE), *_poses())),
            identification_section(found.identification),
            printed_section(found),
            corrected_section(found.corrected),
            over_time_section(found.over_time),
            _errata(found),
        ),
        record=partial(record, found),
    )


def _verdict(checks: tuple[Check, ...]) -> Verdict:
    wrong = sum(not check.agrees for check in checks)
    if not wrong:
        words = "Every number that the text determines is reproduced within its bound."
        return Verdict("agrees", "every check holds", f"{words} {REFERENCE_NOTE}", "Every check holds.")
    words = "Not every number is within its bound: see What holds."
    number = f"{wrong} of {len(checks)} checks"
    return Verdict("disagrees", f"{number} DO NOT HOLD", f"{words} {REFERENCE_NOTE}", f"{number} do not hold.")


def _checks(checks: tuple[Check, ...]) -> Table:
    holds, fails = Verdict("agrees", "holds"), Verdict("disagrees", "DOES NOT HOLD")
    return Table(
        (
            Column("where", "name"),
            Column("verdict", "verdict"),
            Column("what"),
            Column("measured", "number", form=".2g"),
            Column("bound", "number"),
            Column("why this bound", from_width=WIDE_LINE_CHARACTERS),
        ),
        tuple(
            Row(
                (
                    check.where,
                    holds if check.agrees else fails,
                    check.what,
                    check.measured,
                    f"{'≥' if check.at_least else '≤'} {check.bound:.3g}",
                    check.why,
                ),
                "agrees" if check.agrees else "disagrees",
            )
            for check in checks
        ),
        caption="Each number with its bound and the reason for the bound",
    )


def _geometry(found: GeometryTable) -> Table:
    rows = []
    for name, printed, ours in zip(found.rows, found.printed, found.texts, strict=True):
        rows += [
            Row((name, "printed", *(number.text for number in printed)), rule=True),
            Row(("", "graphdyn", *ours)),
        ]
    return Table(
        (Column("parameter", "name"), Column("source", "name"), *BODY_TABLE_COLUMNS),
        tuple(rows),
        caption="As printed, and from 7801 kg/m³ with the cylinder formula",
        repeated=2,
        compact=True,
    )


def _poses() -> tuple[Block, ...]:
    pictures = (
        Picture(
            partial(
                arm_pose, title=f"{title}, {time:g} s", q=joint_motion(time)[0], travel=float(rail(time).translation[0])
            ),
            f"{title}: {time:g} s",
            wide=False,
            on=("page",),
        )
        for title, time in POSE_TIMES.items()
    )
    return *pictures, Prose(BODY_AXES_NOTE, soft=True, on=("page",))


def _errata(found: Reproduction) -> Section:
    blocks = (
        Prose(WHY_ERRATA),
        MEANINGS,
        Picture(
            partial(distributions, effects=found.effects),
            "Histograms of the relative error over the states (A6: over the six masses); line: the bound of the "
            "corrected form, ▲: the largest.",
            title="A1, A4, A5, A6: how large the errors are",
        ),
        Picture(
            partial(towards_lock, effects=found.effects),
            "Cardano angles lose digits as |cos β| falls; the same equations in the twist do not.",
            title="A3: towards gimbal lock",
        ),
        Picture(
            partial(missing_rank, effects=found.effects),
            "The area of a dot is the share of the states.",
            title="A2: rows that are missing",
        ),
        effects_table(found.effects, found.samples, found.seed),
    )
    return Section("errata", "What the printed errors do", blocks)
