"""Single changes of one robot, each of which alone makes it another.

Data need not say which joint is to blame. Where the base may stand anywhere, a first axis that is tilted is a second
one that is tilted the other way, unless the inertia of the link between tells. Every single change is therefore tried:
a length, an angle or an axis at each joint; a mass, center or tensor of each link. With it, base and zeros are fitted
so that all axes and inertias agree. Every change for which they do is a cause that the data allow.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from graphdyn.aligning.axes import JointAxes
from graphdyn.aligning.change_fit import (
    JOINT_KINDS,
    LINK_KINDS,
    NO_CHANGE,
    CauseKind,
    Change,
    ChangeFit,
    FittedChange,
    Flags,
)
from graphdyn.aligning.inertias import LinkInertias
from graphdyn.aligning.joint_map import JointMap
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import Placement


@dataclass(frozen=True)
class Cause:
    """One change that alone makes robot A another one, B.

    element: name in A of the joint, or of the link
    kind: "length", "angle" or "axis" at a joint; "mass", "center" or "tensor" of a link
    """

    element: str
    kind: CauseKind


def explanations(
    robots: tuple[RobotModel, RobotModel],
    axes: tuple[JointAxes, JointAxes],
    joint_map: JointMap,
    tolerance: float,
    kept: Flags | None = None,
) -> dict[Cause | None, FittedChange]:
    """All single changes of A that make it B, with base and zeros; None alone where no change is needed.

    Empty where none of them does alone.

    joint_map: nearly right; kept: which of its zeros are right, None for none                  (n,)
    tolerance: what does not count, as a part of reach, mass and tensor, and in radians
    """
    fit = ChangeFit(robots, axes, joint_map, LinkInertias.of(robots, axes, tolerance), kept)
    changes: list[Change] = [
        (kind, number) for kind in (*JOINT_KINDS, *LINK_KINDS) for number in range(len(joint_map.signs))
    ]
    unchanged = fit.fitted(NO_CHANGE)
    if unchanged is not None:
        return {None: unchanged}
    found: dict[Cause | None, FittedChange] = {}
    for kind, number in fit.promising(changes):
        if kind is not None and (fitted := fit.fitted((kind, number))) is not None:
            names = robots[0].joint_names if kind in JOINT_KINDS else robots[0].body_names
            found[Cause(names[number], kind)] = fitted
    return found


def other_causes(first: RobotModel, model: RobotModel, cause: Cause, tolerance: float) -> tuple[Cause, ...]:
    """Other single changes that make the joint or link of this cause what it is, where all else is as in B.

    model: B in the link frames and joint positions of A
    """
    joints, bodies = list(model.joints), list(model.bodies)
    if cause.kind in JOINT_KINDS:
        number = first.joint_names.index(cause.element)
        joints[number] = first.joints[number]
    else:
        number = first.body_names.index(cause.element)
        bodies[number] = first.bodies[number]
    restored = replace(model, joints=tuple(joints), bodies=tuple(bodies))
    same = JointMap(np.ones(model.n_bodies), np.zeros(model.n_bodies), Placement(), Placement())
    axes = JointAxes.of(restored), JointAxes.of(model)
    found = explanations((restored, model), axes, same, tolerance)
    return tuple(each for each in found if each not in (None, cause))
