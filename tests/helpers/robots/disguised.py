"""One robot written in two ways: other senses, zeros, base, link frames, names; and planted differences."""

from dataclasses import replace

import numpy as np

from graphdyn import Body, JointLimits, Placement, RobotModel
from graphdyn.layout import Array
from graphdyn.model import rotation_about

CHANGES = ("signs", "zeros", "base", "tool", "frames", "names", "limits")
"""What a disguise can change; limits are left out of B, so that they decide nothing."""

KINDS = ("mass", "center", "tensor", "length", "axis")
"""Kinds of planted differences."""

MASS, CENTER, TENSOR, LENGTH, AXIS = 0.05, 5e-3, 0.10, 1e-3, np.deg2rad(0.1)
"""Their sizes: relative, m, relative, m, rad."""


def random_rotation(rng) -> Array:
    axis = rng.normal(size=3)
    return rotation_about(axis / np.linalg.norm(axis), rng.uniform(-np.pi, np.pi))


def motion(joint, position) -> Placement:
    """What a joint does at a position."""
    if joint.is_prismatic:
        return Placement(np.eye(3), position * joint.axis)
    return Placement(rotation_about(joint.axis, position), np.zeros(3))


def disguised(model: RobotModel, rng, changes) -> tuple[RobotModel, Array, Array]:
    """The same robot with these things changed, the senses and the zeros, for which q' = signs q + zeros."""
    n = model.n_bodies
    signs = rng.choice([-1.0, 1.0], size=n) if "signs" in changes else np.ones(n)
    zeros = rng.uniform(-np.pi, np.pi, n) if "zeros" in changes else np.zeros(n)
    zeros = np.where([joint.is_prismatic for joint in model.joints], zeros / 10, zeros)
    frames = [Placement(random_rotation(rng), rng.normal(size=3)) if "base" in changes else Placement()]
    for j, joint in enumerate(model.joints, start=1):
        moved = "frames" in changes or ("tool" in changes and j == n)
        shift = joint.axis * rng.normal() / 10
        frames.append(Placement(random_rotation(rng), shift) if moved else Placement())
    bodies, joints = [], []
    for j, (body, joint, sign, zero) in enumerate(zip(model.bodies, model.joints, signs, zeros, strict=True), start=1):
        here = frames[j]
        turned = here.rotation.T
        placement = frames[joint.inside].inverse() @ joint.placement @ motion(joint, -sign * zero) @ here
        names = (f"part {j}", f"axis {j}") if "names" in changes else (body.name, joint.name)
        ends = [None if end is None else sign * end + zero for end in (joint.limits.lower, joint.limits.upper)]
        limits = replace(joint.limits, lower=ends[0 if sign > 0 else 1], upper=ends[1 if sign > 0 else 0])
        bodies.append(
            Body(
                names[0], body.mass, turned @ (body.center_of_mass - here.translation), turned @ body.inertia @ turned.T
            )
        )
        axis = sign * turned @ joint.axis
        limits = JointLimits() if "limits" in changes else limits
        joints.append(replace(joint, name=names[1], placement=placement, axis=axis, limits=limits))
    base = "ground" if "names" in changes else model.base_name
    return RobotModel(f"{model.name} again", tuple(bodies), tuple(joints), base_name=base), signs, zeros


def planted(model: RobotModel, rng, kind: str, j: int) -> RobotModel:
    """The robot with one thing different at joint j, or in link j, counted from 1."""
    body, joint = model.bodies[j - 1], model.joints[j - 1]
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    if kind == "mass":
        body = replace(body, mass=body.mass * (1 + MASS))
    elif kind == "center":
        body = replace(body, center_of_mass=body.center_of_mass + CENTER * direction)
    elif kind == "tensor":
        body = replace(body, inertia=body.inertia * (1 + TENSOR))
    elif kind == "length":
        along = joint.placement.translation
        size = np.linalg.norm(along)
        longer = along + LENGTH * (along / size if size else direction)
        joint = replace(joint, placement=Placement(joint.placement.rotation, longer))
    else:
        normal = np.cross(joint.axis, direction)
        joint = replace(joint, axis=rotation_about(normal / np.linalg.norm(normal), AXIS) @ joint.axis)
    bodies = (*model.bodies[: j - 1], body, *model.bodies[j:])
    joints = (*model.joints[: j - 1], joint, *model.joints[j:])
    return replace(model, bodies=bodies, joints=joints)
