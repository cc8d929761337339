"""A simulated motion in short, and the format `graphdyn simulate 1`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from crosscheck.reference.subject import OfReading
from crosscheck.report.records.record import CommandRecord, Count, Index, Record, attribute, written
from graphdyn import Simulation
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.simulation import Occurrence
from urdf import Reading


@dataclass(frozen=True)
class SimulatedJoint:
    """A joint, over the whole motion.

    number: 1 … n
    name: as in the file
    prismatic: it slides; the others turn
    lowest, highest: positions [rad or m]
    largest_velocity: largest |v| [rad/s or m/s]
    largest_torque: largest |τ| of the actuator [N m or N]
    largest_force: largest size of the force that the joint transmits; NaN where loops leave a component undetermined
        [N]
    largest_moment: largest size of the moment about the joint, that of the actuator included; NaN as above [N m]
    """

    number: Index
    name: str
    prismatic: bool
    lowest: float
    highest: float
    largest_velocity: float
    largest_torque: float
    largest_force: float
    largest_moment: float


@dataclass(frozen=True)
class PassedLimit:
    """A limit of the file that the motion passes.

    joint: its name
    prismatic: it slides
    kind: of the limit: position, velocity or effort
    limit: as in the file [rad or m, …/s, N m or N]
    farthest: what is farthest beyond it; of velocities and efforts the size   [as limit]
    time: of the first row beyond it [s]
    """

    joint: str
    prismatic: bool
    kind: Literal["position", "velocity", "effort"]
    limit: float
    farthest: float
    time: float


PASSED_SHARE = 1e-6
"""A limit is passed by more than this part of it, of positions at least by as many rad or m: stops are approximate."""


@dataclass(frozen=True, eq=False)
class SimulatedRun(OfReading):
    """A motion and how it came about.

    robot: name or path, as given
    reading: how the file was read
    torque: zero, hold, or the function
    method: dop853, rk8, rk4 or euler
    step: of a method of fixed step; None where steps adapt [s]
    out: the file of the motion
    """

    motion: Simulation
    robot: str
    reading: Reading
    torque: str
    method: str
    step: float | None
    out: str | None

    @property
    def joints(self) -> list[SimulatedJoint]:
        """Joints in the order of the robot."""
        motion = self.motion
        wrenches, (q, v, tau) = motion.reactions.joint_wrenches, of_all_joints(motion)
        forces, moments = (np.linalg.norm(wrenches[..., part], axis=-1).max(axis=0) for part in (LINEAR, ANGULAR))
        return [
            SimulatedJoint(
                number=j + 1,
                name=joint.name,
                prismatic=joint.is_prismatic,
                lowest=float(q[:, j].min()),
                highest=float(q[:, j].max()),
                largest_velocity=float(np.abs(v[:, j]).max()),
                largest_torque=float(np.abs(tau[:, j]).max()),
                largest_force=float(forces[j]),
                largest_moment=float(moments[j]),
            )
            for j, joint in enumerate(motion.model.joints)
        ]

    @property
    def passed_limits(self) -> list[PassedLimit]:
        """Joint by joint: positions, velocities, efforts."""
        found = []
        for joint, q, v, tau in zip(self.motion.model.joints, *(x.T for x in of_all_joints(self.motion)), strict=True):
            limits = joint.limits
            sides: tuple[tuple[Literal["position", "velocity", "effort"], float | None, float, Array], ...] = (
                ("position", limits.lower, -1.0, q),
                ("position", limits.upper, 1.0, q),
                ("velocity", limits.velocity, 1.0, np.abs(v)),
                ("effort", limits.effort, 1.0, np.abs(tau)),
            )
            for kind, limit, sign, values in sides:
                if limit is None:
                    continue
                room = PASSED_SHARE * max(abs(limit), 1.0 if kind == "position" else 0.0)
                beyond = sign * (values - limit) > room
                if beyond.any():
                    farthest, first = sign * float((sign * values).max()), float(self.motion.time[np.argmax(beyond)])
                    found.append(PassedLimit(joint.name, joint.is_prismatic, kind, float(limit), farthest, first))
        return found


def of_all_joints(motion: Simulation) -> tuple[Array, Array, Array]:
    """q, v and tau (N, n_bodies), those of joints that others drive included."""
    degrees_of_freedom, tau = motion.model.degrees_of_freedom, np.zeros((len(motion.time), motion.model.n_bodies))
    tau[:, list(degrees_of_freedom.independent)] = motion.tau
    return motion.model.joint_positions(motion.q), motion.v @ degrees_of_freedom.matrix.T, tau


class OccurrenceRecord(Record, of=Occurrence, only=("name", "time")):
    """An event."""


class SimulateRecord(CommandRecord, of=SimulatedRun, leave_out=("motion", "reading"), format="graphdyn simulate 1"):
    """A motion in short; the motion itself is what --out writes.

    duration: that was simulated [s]
    rows: of the result
    energy_drift: largest error of the balance of energy as a part of the largest kinetic energy
    closure_error: largest |φ| of joints [m, -] and loops [m, rad]
    """

    locked = attribute()
    chain = attribute()
    duration: float
    rows: Count
    ended = attribute("motion.ended")
    occurrences: Sequence[OccurrenceRecord] = attribute("motion.occurrences")
    energy_drift: float = attribute("motion.energy.drift")
    closure_error: float
    joints = attribute()
    passed_limits = attribute()


def record(run: SimulatedRun, command: Sequence[str]) -> dict[str, Any]:
    return written(
        SimulateRecord,
        run,
        command=command,
        duration=run.motion.time[-1],
        rows=len(run.motion.time),
        closure_error=run.motion.closure_error().max(),
    )
