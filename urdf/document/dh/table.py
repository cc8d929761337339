"""A table of Denavit-Hartenberg parameters, with base, tool and the inertias of the links.

With Rot and Tra about and along an axis, the transform from one frame to the next is

    standard   Rot_z(θ) Tra_z(d) Tra_x(a) Rot_x(α) Rot_y(β)
    modified   Rot_x(α) Tra_x(a) Rot_y(β) Rot_z(θ) Tra_z(d)

where the joint adds its position, times its sign, to θ, or to d where it slides. Standard: Denavit and Hartenberg,
Journal of Applied Mechanics 22, 1955; modified: Craig, "Introduction to Robotics", section 3.4. β, with d = 0, stands
for d where two axes are nearly parallel and their common normal lies far away: Hayati, IEEE Conference on Decision and
Control, 1983.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from graphdyn import Body, JointLimits, Placement
from graphdyn.display import short_repr
from graphdyn.layout import Array
from graphdyn.model import rotation_about

Convention = Literal["standard", "modified"]

CONVENTIONS: tuple[Convention, ...] = get_args(Convention)

X, Y, Z = np.eye(3)


@dataclass(frozen=True, eq=False)
class DHLink:
    """A link that a joint moves.

    body: mass, center of mass and tensor about it, in the frame of the link's row; None: without mass
    """

    name: str
    body: Body | None


@dataclass(frozen=True, eq=False)
class DHRow:
    """One joint and its link.

    theta, alpha, beta [rad]; d, a [m]; sign: 1 or -1, the sense in which the joint counts
    kind: "revolute", "continuous" or "prismatic"
    damping [N m s/rad or N s/m], friction [N m or N], armature [kg m² or kg]
    """

    name: str
    kind: str
    theta: float
    d: float
    a: float
    alpha: float
    beta: float
    link: DHLink
    sign: float = 1.0
    limits: JointLimits = field(default_factory=JointLimits)
    damping: float = 0.0
    friction: float = 0.0
    armature: float = 0.0

    @property
    def along_z(self) -> Placement:
        """Rot_z(θ) Tra_z(d) at q = 0."""
        return Placement(rotation_about(Z, self.theta), self.d * Z)

    @property
    def along_x(self) -> Placement:
        """Tra_x(a) Rot_x(α) Rot_y(β)."""
        return along_normal(self.a, self.alpha, self.beta)


def along_normal(a: float, alpha: float, beta: float) -> Placement:
    """Tra_x(a) Rot_x(α) Rot_y(β)."""
    return Placement(rotation_about(X, alpha) @ rotation_about(Y, beta), a * X)


@dataclass(frozen=True, eq=False)
@short_repr
class DHTable:
    """A serial robot.

    name: of the robot; convention: "standard" or "modified"
    base: placement of the first frame in the base link; tool: of the frame `tool_name` in that of the last row
    gravity: (3,) [m/s²], in axes of the base link
    choices: what in a table made of a model could as well be otherwise, in words
    """

    name: str
    convention: Convention
    base: Placement
    rows: tuple[DHRow, ...]
    tool: Placement
    tool_name: str
    base_name: str
    gravity: Array
    choices: tuple[str, ...] = ()

    def joint_placements(self) -> list[Placement]:
        """Placement of each joint at q = 0, with its axis along z: in the one before it, of the first in the base
        link."""
        standard = self.convention == "standard"
        before = self.base
        found = []
        for row in self.rows:
            found.append(before @ row.along_z if standard else before @ row.along_x @ row.along_z)
            before = row.along_x if standard else Placement()
        return found

    def frame_of(self, row: DHRow) -> Placement:
        """The frame of a row in that of its joint."""
        return row.along_x if self.convention == "standard" else Placement()
