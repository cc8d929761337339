"""Section 3.2 as the paper prints it: 30 multipliers from the printed constraints and measured motion.

A q̈ - B + φ_qᵀ λ = 0 with q̈ and B measured. B was formed from the joint forces and moments without gravity, so that
A q̈ - B is the weight of each body and nothing else (docs/deviations.md, C4): φ_qᵀ λ = -F^g. The axis rows of joints 2,
3 and 5, whose axes are horizontal, are dependent (A2): their multipliers are not determined, and the moment about the
axis, which the actuator carries, has no column. The printed values of the joints before these follow if that moment is
transmitted to the next body; here two moments, one of them about the axis, replace the two dependent rows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from crosscheck.paper.errata import world_axis_rows
from crosscheck.paper.tables import joint_motion, rail
from graphdyn import MaximalState, kr500, maximal_state
from graphdyn.equations import joint_axes
from graphdyn.layout import ANGULAR, LINEAR, Array, body_rows, joint_rows

DEPENDENT_ROW_SHARE = 1e-9
"""Part of the largest singular value below which one is rounding; the smallest other one is 1e-2 of the largest."""

TURNED_JOINTS = (2, 3, 5)
"""Joints whose fourth row is written with -e_2 instead of e_2, which changes the sign of λ_j4 (B9)."""

INSTANT = 1.5
"""The time of section 3.2 [s]."""


@dataclass(frozen=True, eq=False)
class PrintedMultipliers:
    """The multipliers that follow from the printed constraints.

    rank, n_rows: of φ_q (30 rows for 30 multipliers)
    values: λ_j1 … λ_j5; NaN where the rows of a joint are dependent           (6, 5)  [N, N m]
    ratios: per joint with dependent rows, λ_j4 / λ_j5 of the null vector, the only part of λ_j4 and λ_j5 to compare
    left: largest entry of φ_qᵀ λ + F^g, relative to the largest weight
    """

    rank: int
    n_rows: int
    values: Array
    ratios: Mapping[int, float]
    left: float


def printed_rank(time: float) -> int:
    """Rank of the 30 printed rows at a time [s]."""
    return int(_rank(_rows(_state(time))))


def printed_multipliers(time: float = INSTANT) -> PrintedMultipliers:
    """Solve φ_qᵀ λ = -F^g with the printed rows."""
    state = _state(time)
    rows, axes = _rows(state), joint_axes(state)
    columns, ratios = rows.T.copy(), {}
    for j in range(1, 7):
        last = slice(joint_rows(j).start + 3, joint_rows(j).stop)
        pair = rows[last]
        if _rank(pair) == 2:
            continue
        null = np.linalg.svd(pair)[0][:, -1]  # null · pair = 0
        ratios[j] = float(null[0] / null[1])
        columns[:, last] = np.stack([_moment(state, j, np.array([0, 0, 1.0])), _moment(state, j, axes[j - 1])], axis=-1)
    weights = np.zeros(36)
    for i, body in enumerate(state.model.bodies, start=1):
        weights[body_rows(i)][LINEAR] = body.mass * state.model.gravity
    solution = np.linalg.lstsq(columns, -weights, rcond=None)[0]
    values: Array = np.array(solution.reshape(6, 5))
    for j in ratios:
        values[j - 1, 3:] = np.nan
    left = float(np.abs(columns @ solution + weights).max() / np.abs(weights).max())
    return PrintedMultipliers(_rank(rows), len(rows), values, ratios, left)


def _state(time: float) -> MaximalState:
    return maximal_state(kr500(), *joint_motion(time), base=rail(time))


def _rows(state: MaximalState) -> Array:
    """φ_q (30, 36) as printed, Eq. (75)-(104)."""
    rows = world_axis_rows(state)
    for j in TURNED_JOINTS:
        rows[joint_rows(j).start + 3] *= -1
    return rows


def _rank(rows: Array) -> int:
    return int(np.linalg.matrix_rank(rows, tol=DEPENDENT_ROW_SHARE * np.linalg.norm(rows, 2)))


def _moment(state: MaximalState, j: int, direction: Array) -> Array:
    """The column of φ_qᵀ of a moment between body j and its inside body, about a direction in world axes (36,)."""
    column = np.zeros(36)
    inside = state.model.joints[j - 1].inside
    for body, sign in ((inside, 1.0), (j, -1.0)):
        if body:
            column[body_rows(body)][ANGULAR] = sign * (direction @ state.rotation[body - 1])
    return column
