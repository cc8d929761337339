"""Limits of a joint, to and from the attributes of <limit>."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from graphdyn import Joint, JointLimits

if TYPE_CHECKING:
    import yourdfpy

NO_LIMIT = sys.float_info.max
"""Effort or velocity limit that means "none".

The URDF schema demands both attributes wherever <limit> is, and <limit> for revolute and prismatic joints; urdfdom
(and so Pinocchio) refuses files without them. The largest double is a finite number that every reader accepts; zero
would say that the joint cannot move.
"""


def from_urdf(joint: yourdfpy.urdf.Joint) -> JointLimits:
    """The limits as the file states them, None where it states none. A continuous joint has no position limits."""
    if joint.limit is None:
        return JointLimits()
    bounded = joint.type != "continuous"
    return JointLimits(
        lower=joint.limit.lower if bounded else None,
        upper=joint.limit.upper if bounded else None,
        velocity=None if joint.limit.velocity == NO_LIMIT else joint.limit.velocity,
        effort=None if joint.limit.effort == NO_LIMIT else joint.limit.effort,
    )


def to_attributes(joint: Joint) -> dict[str, float]:
    """The attributes of <limit>; empty where the joint needs none."""
    limits = joint.limits
    bounds = {"lower": limits.lower, "upper": limits.upper} if joint.kind != "continuous" else {}
    given = {name: value for name, value in bounds.items() if value is not None}
    if joint.kind == "continuous" and limits.velocity is None and limits.effort is None:
        return {}
    return given | {
        "effort": NO_LIMIT if limits.effort is None else limits.effort,
        "velocity": NO_LIMIT if limits.velocity is None else limits.velocity,
    }
