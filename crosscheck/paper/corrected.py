"""Section 3.2 corrected: the 30 multipliers of the whole motion, gravity included, beside Pinocchio's rnea.

They are computed at one instant, and with joint forces and moments at every time of the experiment.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.paper.multipliers import INSTANT, printed_rank
from crosscheck.paper.tables import joint_motion, rail
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.reference_values import multipliers_of
from graphdyn import BaseMotion, VirtualRecording, inverse_dynamics, kr500, kr500_experiment, maximal_state
from graphdyn.equations import joint_axes
from graphdyn.experiments import RAIL_ACCELERATION
from graphdyn.layout import ANGULAR, LINEAR, Array


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
    there = PinocchioModel.from_model(model).carried(q[None], v[None], a[None], ours.tau[None], motion)
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
