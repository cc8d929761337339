"""Limits of a joint, to and from the attributes of <limit>."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from graphdyn import Joint, JointLimits

if TYPE_CHECKING:
    import yourdfpy

NO_LIMIT = sys.float_info.max
"""Effort or velocity limit that save writes where the model has none.

The URDF schema demands both attributes in every <limit>, and <limit> for revolute and prismatic joints; urdfdom
(and so Pinocchio) refuses files without them. The largest double is a finite number that every reader accepts; zero
would mean that the joint cannot move.
"""

MIN_UNLIMITED = 1.79769e308
"""Magnitude from which a limit counts as none: SDFormat and others print the largest double with six digits."""


def from_urdf(joint: yourdfpy.urdf.Joint) -> JointLimits:
    """The limits as the file states them, None where it states none. A continuous joint has no position limits."""
    if joint.limit is None:
        return JointLimits()
    bounded = joint.type != "continuous"
    return JointLimits(
        lower=_stated(joint.limit.lower) if bounded else None,
        upper=_stated(joint.limit.upper) if bounded else None,
        velocity=_stated(joint.limit.velocity),
        effort=_stated(joint.limit.effort),
    )


def _stated(limit: float | None) -> float | None:
    return None if limit is None or abs(limit) >= MIN_UNLIMITED else limit


def to_attributes(joint: Joint) -> dict[str, float]:
    """The attributes of <limit>; empty where the joint needs none."""
    limits = joint.limits
    if joint.kind == "continuous" and limits.velocity is None and limits.effort is None:
        return {}
    bounds: dict[str, float] = {}
    if joint.kind != "continuous" and not (limits.lower is None and limits.upper is None):
        # readers take a single missing bound as zero
        bounds = {
            "lower": -NO_LIMIT if limits.lower is None else limits.lower,
            "upper": NO_LIMIT if limits.upper is None else limits.upper,
        }
    return bounds | {
        "effort": NO_LIMIT if limits.effort is None else limits.effort,
        "velocity": NO_LIMIT if limits.velocity is None else limits.velocity,
    }
