"""Wrong units: of positions, velocities, lengths and rpy angles."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.judging.experiments import Function, torques
from crosscheck.judging.faults.changes import moved, of_joints, rotation_from, rpy_of, turned, with_joints
from crosscheck.judging.faults.fault import Fault
from graphdyn import RobotModel
from graphdyn.layout import Array


def units(model: RobotModel) -> Iterator[Fault]:
    own, angle = torques(model), np.array([not joint.is_prismatic for joint in model.joints])
    degrees = np.where(angle, np.rad2deg(1.0), 1.0)
    for factor, said in ((1 / degrees, "degrees"), (degrees, "radians where the code means degrees")):
        for which, what in ((slice(0, 3), "positions, velocities and accelerations"), (slice(0, 1), "positions")):
            yield Fault(
                "unit",
                f"joint {what} are taken as {said}",
                "convert angles to radians when they are read",
                _scaled_input(own, factor, which),
            )
    rpm = np.where(angle, 2 * np.pi / 60, 1.0)
    for factor, said in ((1 / degrees, "degrees per second"), (rpm, "rev/min")):
        yield Fault(
            "unit",
            f"joint velocities are taken as {said}",
            "convert velocities to rad/s when they are read",
            _scaled_input(own, factor, slice(1, 2)),
        )
    for length, said in ((1e3, "millimetres"), (1e2, "centimetres"), (1 / 0.0254, "inches")):
        yield Fault(
            "unit",
            f"the joint placements are in {said}, the rest in metres",
            "convert lengths to metres",
            with_joints(model, lambda joint, f=length: moved(joint, f * joint.placement.translation)),  # type: ignore[misc]
        )
    for turn, said in ((np.pi / 180, "degrees"), (180 / np.pi, "radians, but the code means degrees")):
        yield from of_joints(
            model,
            "unit",
            f"the rpy angles of {{who}} are taken as {said}",
            "URDF gives rpy in radians",
            lambda joint, f=turn: turned(joint, rotation_from(f * rpy_of(joint))),  # type: ignore[misc]
        )


def _scaled_input(own: Function, factor: Array, which: slice) -> Function:
    def torque(*state: Array) -> Array:
        chosen = range(3)[which]
        return own(*(factor * x if k in chosen else x for k, x in enumerate(state)))

    return torque
