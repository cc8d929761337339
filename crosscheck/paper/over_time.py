"""The whole experiment of section 3: thirty multipliers, joint forces and moments at every time, beside rnea."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.paper.as_printed import INSTANT, printed_rank
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.reference_values import multipliers_of
from graphdyn import BaseMotion, VirtualRecording, inverse_dynamics, kr500, kr500_experiment, maximal_state
from graphdyn.experiments import RAIL_ACCELERATION
from graphdyn.layout import ANGULAR, LINEAR, Array

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
    t, acceleration = recording.time, np.zeros((len(recording.time), 6))
    acceleration[:, 0] = RAIL_ACCELERATION
    translation = 0.5 * t[:, None] ** 2 * acceleration[:, LINEAR]
    base = BaseMotion(translation=translation, velocity=t[:, None] * acceleration, acceleration=acceleration)
    q, v, a = recording.q, recording.v, recording.a
    ours = inverse_dynamics(model, q, v, a, base=base, method="dense")
    there = PinocchioModel.from_model(model).carried(q, v, a, recording.tau, base)
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
