"""The constants of a robot, per body, in the frame that makes its joint simple.

The recursions work in joint axes: origin O_j, axes (t_1, t_2, p) of joint j turning with body j. A revolute joint is
then a turn about z, a prismatic joint a slide along z, whatever its axis in the link frame. Where the axis is a
coordinate axis the change of frame is a signed permutation and costs nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.layout import Array
from graphdyn.model.inertia import parallel_axis
from graphdyn.model.robot_model import RobotModel
from graphdyn.scalars.vectors import Scalars, scalars

ROTATION_ROUNDING = 4 * float(np.finfo(float).eps)
"""Entries of a rotation this close to 0 or ±1 are rounded to it: a product of three rotations has errors of this size.
Those of nearly right angles (1.5707963 for π/2) are two hundred million times larger, and stay as they are."""


@dataclass(frozen=True, eq=False)
class Link:
    """Body j and its inside joint; vectors in joint axes of body j unless stated otherwise.

    inside: index of the inside body, -1 for the ground
    prismatic: whether the joint slides
    rotation, translation: placement of the joint axes at q = 0, in joint axes of the inside body
    link_axes: Q, from joint axes to link axes
    mass, center_of_mass, first_moment, tensor: m, c, m c, I about O_j
    slide: how far O_j lies along p_j from the link origin
    at_zero: cosine and sine of the angle at q = 0; adding an angle to q would round it
    """

    inside: int
    prismatic: bool
    rotation: Scalars
    translation: Scalars
    link_axes: Scalars
    mass: float
    center_of_mass: Scalars
    first_moment: Scalars
    tensor: Scalars
    slide: float = 0.0
    at_zero: tuple[Any, Any] = (1.0, 0.0)


Links = Sequence[Link]


def links(model: RobotModel) -> tuple[Link, ...]:
    """All bodies; the joint axes of the ground are those of the ground frame."""
    axes = [np.eye(3), *(np.column_stack([*joint.axis_normals, joint.axis]) for joint in model.joints)]
    result = []
    for number, (body, joint) in enumerate(zip(model.bodies, model.joints, strict=True), start=1):
        inside, own = axes[joint.inside], axes[number]
        center = own.T @ body.center_of_mass
        result.append(
            Link(
                inside=joint.inside - 1,
                prismatic=joint.is_prismatic,
                rotation=scalars(rounded(inside.T @ joint.placement.rotation @ own)),
                translation=scalars(inside.T @ joint.placement.translation),
                link_axes=scalars(rounded(own)),
                mass=body.mass,
                center_of_mass=scalars(center),
                first_moment=scalars(body.mass * center),
                tensor=scalars(own.T @ body.inertia @ own + parallel_axis(body.mass, center)),
            )
        )
    return tuple(result)


def path(links: Links, body: int) -> list[int]:
    """Indices of the joints from the ground to a body, outwards; none to the ground, -1."""
    return [] if body < 0 else [*path(links, links[body].inside), body]


def rounded(rotation: Array) -> Array:
    """The matrix with 0 and ±1 where rounding has left something else."""
    nearest = np.round(rotation)
    cleaned: Array = np.where(np.abs(rotation - nearest) <= ROTATION_ROUNDING, nearest, rotation)
    return cleaned


def without_rounding(values: Array, size: float) -> Array:
    """The sum with 0 where rounding has left something else of a sum; size: of the terms."""
    cleaned: Array = np.where(np.abs(values) <= ROTATION_ROUNDING * size, 0.0, values)
    return cleaned
