"""Wrong units: of positions, velocities, lengths and rpy angles, of all joints or of one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from crosscheck.judging.faults.changes import joints_said, of_joints, rotation_from
from crosscheck.judging.faults.fault import Change, CodeFault
from graphdyn import RobotModel
from graphdyn.layout import Array
from urdf.document import rpy_from_rotation

LENGTH_UNITS = {"millimeters": 1e3, "centimeters": 1e2, "inches": 1 / 0.0254}
"""Units that a length may be in, per meter."""


def units(model: RobotModel) -> Iterator[CodeFault]:
    slides = np.array([joint.is_prismatic for joint in model.joints])
    degree = np.pi / 180
    sets = [[k] for k in range(model.n_bodies)] + ([list(range(model.n_bodies))] if model.n_bodies > 1 else [])
    for joints in sets:
        who = "joint" if len(joints) > 1 else joints_said(model, joints)
        turning, sliding = [k for k in joints if not slides[k]], [k for k in joints if slides[k]]
        of = f"{who} {{what}}" if len(joints) > 1 else f"{{what}} of {who}"
        if turning:
            for factor, unit in ((degree, "degrees"), (1 / degree, "radians where the code means degrees")):
                yield _scaled(model, turning, of, "positions, velocities and accelerations", unit, factor, "qva")
                yield _scaled(model, turning, of, "positions", unit, factor, "q")
            yield _scaled(model, turning, of, "velocities", "degrees per second", degree, "v")
            yield _scaled(model, turning, of, "velocities", "rev/min", 2 * np.pi / 60, "v")
        if sliding and (len(joints) == 1 or len(sliding) > 1):
            of_slides = of if len(joints) == 1 else "sliding {what}"
            for unit, per_meter in LENGTH_UNITS.items():
                what = "positions, velocities and accelerations"
                yield _scaled(model, sliding, of_slides, what, unit, 1 / per_meter, "qva")
                yield _scaled(model, sliding, of_slides, "positions", unit, 1 / per_meter, "q")
    for unit, per_meter in LENGTH_UNITS.items():
        yield from of_joints(
            model,
            "unit",
            f"the placement of {{who}} is in {unit}, the rest in meters",
            "convert lengths to meters",
            lambda x, j, f=per_meter: {"translations": f * x.translations[j]},  # type: ignore[misc]
        )
    for turn, said in ((degree, "degrees"), (1 / degree, "radians, but the code means degrees")):
        yield from of_joints(
            model,
            "unit",
            f"the rpy angles of {{who}} are taken as {said}",
            "URDF gives rpy in radians",
            lambda x, j, f=turn: {"rotations": rotation_from(f * rpy_from_rotation(x.rotations[j]))},  # type: ignore[misc]
        )


def _scaled(
    model: RobotModel, joints: Sequence[int], of: str, what: str, unit: str, factor: float, which: str
) -> CodeFault:
    """Some of q, v, a multiplied by a factor at some joints."""
    scale = np.where(np.isin(np.arange(model.n_bodies), joints), factor, 1.0)

    def state(q: Array, v: Array, a: Array) -> tuple[Array, Array, Array]:
        taken = {"q": q, "v": v, "a": a}
        return tuple(scale * x if name in which else x for name, x in taken.items())  # type: ignore[return-value]

    change: Change = lambda code: code.taking(state)  # noqa: E731
    said = of.format(what=what)
    return CodeFault.of(
        "unit", f"{said} are taken as {unit}", "convert to rad, m, rad/s, m/s when they are read", change
    )
