"""Section 3.2 as the paper prints it, and corrected: 30 multipliers beside those of Pinocchio's rnea.

As printed they follow, number by number, from printed constraints and measured motion.
A q̈ - B + φ_qᵀ λ = 0 with q̈ and B measured. B was formed from the joint forces and moments without gravity, so that
A q̈ - B is the weight of each body and nothing else (docs/deviations.md, C4): φ_qᵀ λ = -F^g. The axis rows of joints 2,
3 and 5, whose axes are horizontal, are dependent (A2): their multipliers are not determined, and the moment about the
axis, which the actuator carries, has no column. The printed values of the joints before these follow if that moment is
transmitted to the next body; here two moments, one of them about the axis, replace the two dependent rows.

Corrected they are those of the whole motion, gravity included: at one instant, and with joint forces and moments at
every time of the experiment.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from crosscheck.paper.errata import world_axis_rows
from crosscheck.paper.printed import MULTIPLIERS, Printed
from crosscheck.paper.tables import joint_motion, rail
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.pinocchio_model.moving_base import carried
from crosscheck.reference.reference_values import multipliers_of
from graphdyn import (
    MaximalState,
    VirtualRecording,
    inverse_dynamics,
    kr500,
    kr500_experiment,
    maximal_state,
)
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


MIN_REPRODUCED_DIGITS = 6
"""Number of equal significant digits from which a multiplier is reproduced: the paper has seven, with rounding."""

PRINTED_DIGITS = 7

Kind = Literal["reproduced", "rounding", "free", "unexplained"]

MEANINGS: Mapping[Kind, str] = {
    "reproduced": "reproduced",
    "rounding": "zero; the paper prints rounding of its seven digits",
    "free": "not determined: the two axis rows of this joint are dependent (A2)",
    "unexplained": "not reproduced: no interpretation of the text known to us gives these two",
}
"""Kinds of printed numbers, in words."""

WHY_PRINTED = (
    "λ_j3 is the weight outside joint j, since B was formed from measured joint forces without gravity (C4); λ_33 is "
    "printed without its minus (B6). The axes of joints 2, 3 and 5 are horizontal and their two axis rows dependent "
    "(A2): the printed 1e10 to 1e11 are a null vector divided by rounding, whose size no program can reproduce; its "
    "ratio is tan 33.75°, the angle of joint 1. λ_44 and λ_45 follow when joint 5 passes the moment about its axis on "
    "to joint 4. λ_14 and λ_15 are not reproduced. λ_42 = 30.072190e-4 has one digit too many, and is rounding anyway."
)


@dataclass(frozen=True)
class Multiplier:
    """One of the thirty multipliers.

    joint, number: j and k of λ_jk; printed: in the paper
    ours: from the printed rows, NaN where they do not determine it [N, N m]
    kind: what the printed number is
    digits: significant digits of seven that agree, where the kind is reproduced; otherwise 0
    """

    joint: int
    number: int
    printed: Printed
    ours: float
    kind: Kind
    digits: int

    @property
    def name(self) -> str:
        """λ_jk: joint j, number k."""
        return f"λ_{self.joint}{self.number}"

    @property
    def meaning(self) -> str:
        """The kind in words."""
        return MEANINGS[self.kind]


def agreeing_digits(printed: float, ours: float) -> int:
    """Number of significant digits, at most seven, to which two numbers agree within half a unit of the last digit."""
    if not (math.isfinite(printed) and math.isfinite(ours)) or printed == 0:
        return 0
    exponent = math.floor(math.log10(abs(printed)))
    fitting = (k for k in range(PRINTED_DIGITS, 0, -1) if abs(printed - ours) <= 0.5 * 10.0 ** (exponent - k + 1))
    return next(fitting, 0)


def multipliers(solved: PrintedMultipliers) -> tuple[Multiplier, ...]:
    """λ_61 … λ_65, λ_51 … λ_15, in the order of the paper."""
    rows = tuple(MULTIPLIERS.rows.values())
    return tuple(
        _multiplier(solved, joint, number, rows[number - 1][joint - 1])
        for joint in range(6, 0, -1)
        for number in range(1, 6)
    )


def _multiplier(solved: PrintedMultipliers, joint: int, number: int, printed: Printed) -> Multiplier:
    ours = float(solved.values[joint - 1, number - 1])
    kind: Kind
    if number in (1, 2):
        kind = "rounding"
    elif np.isnan(ours):
        kind = "free"
    else:
        kind = "unexplained" if joint == 1 and number > 3 else "reproduced"
    digits = agreeing_digits(printed.value, ours) if kind == "reproduced" else 0
    return Multiplier(joint, number, printed, ours, kind, digits)


def printed_ratios() -> Mapping[int, float]:
    """λ_j4 / λ_j5 as printed, of the joints whose rows are dependent."""
    fourth, fifth = MULTIPLIERS.values[3:5]
    return {j: float(fourth[j - 1] / fifth[j - 1]) for j in (2, 3, 5)}


@dataclass(frozen=True, eq=False)
class CorrectedMultipliers:
    """The multipliers that follow from the corrected constraints, and Pinocchio's.

    multipliers, rnea: force in world axes, moments about t_1, t_2, of the inside body on body j   (6, 5)  [N, N m]
    difference: largest one, relative to the largest force or moment of its kind
    tau: actuator torques                                                       (6,)    [N m]
    forces: of the inside body on body j, world axes                            (6, 3)  [N]
    moments: the same about O_j, actuator included, world axes                  (6, 3)  [N m]
    reading: one sentence per joint about the forces and moments it carries     (6,)
    """

    multipliers: Array
    rnea: Array
    difference: float
    tau: Array
    forces: Array
    moments: Array
    reading: tuple[str, ...]


def corrected_multipliers(time: float = INSTANT) -> CorrectedMultipliers:
    """All multipliers of the paper's motion at a time [s]."""
    model, motion = kr500(), rail(time)
    q, v, a = joint_motion(time)
    ours = inverse_dynamics(model, q, v, a, base=motion, method="dense")
    there = carried(PinocchioModel.from_model(model), q[None], v[None], a[None], ours.tau[None], motion)
    state = maximal_state(model, q, v, a, base=motion)
    rnea = multipliers_of(model, state.rotation, there.joint_wrenches[0])
    forces, moments = (
        np.einsum("iab,ib->ia", state.rotation, ours.joint_wrenches[:, part]) for part in (LINEAR, ANGULAR)
    )
    kinds = slice(0, 3), slice(3, 5)
    differences = [np.abs(ours.multipliers[:, k] - rnea[:, k]).max() / np.abs(rnea[:, k]).max() for k in kinds]
    reading = tuple(
        _reading(name, force, moment, axis, torque)
        for name, force, moment, axis, torque in zip(
            model.joint_names, forces, moments, joint_axes(state), ours.tau, strict=True
        )
    )
    return CorrectedMultipliers(ours.multipliers, rnea, float(np.max(differences)), ours.tau, forces, moments, reading)


def _reading(name: str, force: Array, moment: Array, axis: Array, torque: float) -> str:
    """A sentence on vertical and horizontal force, the moment about the axis (the actuator's), and that across it."""
    across = np.linalg.norm(moment - torque * axis)
    return (
        f"{name} carries {force[2] / 1e3:.1f} kN upwards and {np.hypot(*force[:2]) / 1e3:.1f} kN sideways; "
        f"its actuator gives {torque / 1e3:.2f} kN m about the axis, its bearings {across / 1e3:.2f} kN m across it"
    )


REVOLUTE_MOMENTS = slice(3, 5)
"""The moments among the five multipliers of a revolute joint; LINEAR are the forces."""

RANK_TIMES = (0.0, 0.02, INSTANT, 2.0)
"""Times at which the rank of the printed rows is shown [s]: at rest, just after, in section 3.2, at the end."""


@dataclass(frozen=True, eq=False)
class OverTime:
    """The experiment at 101 times from 0 to 2 s.

    recording: graphdyn's experiment
    multipliers, rnea: of the corrected model, and from the wrenches of rnea   (N, 6, 5)  [N, N m]
    rnea_moments: of the inside body on body j at O_j, world axes    (N, 6, 3)  [N m]
    rnea_tau: of the actuators                              (N, 6)     [N m]
    difference: largest of multipliers, forces, moments and torques, relative to the largest of its kind
    ranks: time → rank of the printed axis rows of the 30
    """

    recording: VirtualRecording
    multipliers: Array
    rnea: Array
    rnea_moments: Array
    rnea_tau: Array
    difference: float
    ranks: dict[float, int]


def over_time() -> OverTime:
    """The experiment with its motion, from rest, on the rail."""
    model, recording = kr500(), kr500_experiment()
    q, v, a, base = recording.q, recording.v, recording.a, rail(recording.time)
    ours = inverse_dynamics(model, q, v, a, base=base, method="dense")
    there = carried(PinocchioModel.from_model(model), q, v, a, recording.tau, base)
    rotation = maximal_state(model, q, v, a, base=base).rotation
    rnea = multipliers_of(model, rotation, there.joint_wrenches)
    forces, moments = (
        np.einsum("...ab,...b->...a", rotation, there.joint_wrenches[..., part]) for part in (LINEAR, ANGULAR)
    )
    pairs = (
        (ours.multipliers[..., LINEAR], rnea[..., LINEAR]),
        (ours.multipliers[..., REVOLUTE_MOMENTS], rnea[..., REVOLUTE_MOMENTS]),
        (recording.joint_forces, forces),
        (recording.joint_moments, moments),
        (recording.tau, there.tau),
    )
    difference = float(np.max([np.abs(here - other).max() / np.abs(other).max() for here, other in pairs]))
    ranks = {time: printed_rank(time) for time in RANK_TIMES}
    return OverTime(recording, ours.multipliers, rnea, moments, there.tau, difference, ranks)
