"""Steps in world axes, about the origin of each body: where bodies are, how they move, what those outside add up to.

What one body means for another then needs no rotation: a wrench about one origin is moved to the next by the arm
between both, a motion likewise. Velocities are relative to the origins, so that no digits are lost far from the ground.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from graphdyn.compiler.rolled.program import Pass
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.recursions.inertia import Composite
from graphdyn.recursions.inverse import Wrench, inwards, unloaded
from graphdyn.recursions.motion import BodyMotion, JointPlacement, inertial_wrench, places, resting_root, rotations
from graphdyn.scalars.vectors import Scalars, cross, scalars, symmetric, zeros


def ground(x: BodyStep) -> None:
    """The ground frame, with its origin at joint 1."""
    root = x.root
    x.keep("rotation", root.rotation)
    x.keep("origin", root.position)
    x.keep("reach", zeros(3))
    x.keep("alpha", root.rotation @ root.alpha)
    x.keep("omega", root.rotation @ root.omega)
    x.keep("velocity", root.rotation @ root.velocity)
    x.keep("compensated", root.rotation @ root.compensated)
    for name, shape in SUMS.items():
        x.sum(name, zeros(*shape))


SUMS: dict[str, tuple[int, ...]] = {
    "mass": (),
    "moment": (3,),
    "tensor": (3, 3),
    "impulse": (3,),
    "flow": (3, 3),
    "wrench": (2, 3),
}
"""Shapes of what bodies add to their inside bodies (gathered)."""


def placed(x: BodyStep) -> None:
    """Place of the body: its joint axes, and the arm from the origin of the inside body."""
    (place,) = places([x.link], [x.joint("q")])
    inside = x.inside("rotation")
    arm = inside @ place.translation
    x.keep("rotation", rotations([x.link], [place], replace(resting_root(), rotation=inside))[0])
    x.keep("arm", arm)
    x.keep("origin", x.inside("origin") + arm)
    x.keep("reach", x.inside("reach") + arm)  # from joint 1


def axis(x: BodyStep) -> Scalars:
    """p_j, once it is placed."""
    return x.kept("rotation")[:, 2]


def moved(x: BodyStep, rate: Any, acceleration: Any) -> None:
    """ω, ω̇ and the gravity-compensated acceleration of its origin; how fast this leaves that of the inside body."""
    placed(x)
    omega, alpha, arm, p = x.inside("omega"), x.inside("alpha"), x.kept("arm"), axis(x)
    change = cross(omega, arm)
    compensated = x.inside("compensated") + cross(alpha, arm) + cross(omega, change)
    x.keep("turned_axis", cross(omega, p))
    if x.prismatic:
        change = change + p * rate
        compensated = compensated + cross(omega, p * (2.0 * rate)) + p * acceleration
    else:
        alpha = alpha + cross(omega, p * rate) + p * acceleration
        omega = omega + p * rate
    x.keep("omega", omega)
    x.keep("alpha", alpha)
    x.keep("compensated", compensated)
    x.keep("change", change)
    x.keep("velocity", x.inside("velocity") + change)


def at_arm(arm: Scalars) -> JointPlacement:
    """A placement that turns nothing."""
    return JointPlacement(scalars(np.eye(3)), 1.0, 0.0, arm)


# Sums over a body and all bodies outside


def moving(x: BodyStep) -> None:
    """Place and motion of the body, and what it adds to the sums."""
    moved(x, x.joint("v"), x.joint("a"))
    alone(x)


def alone(x: BodyStep) -> None:
    """What the body itself adds: m, m c and I; ∫ ċ dm and ∫ ċ cᵀ dm; the wrench that its motion takes."""
    link, to_world = x.link, x.kept("rotation")
    moment = to_world @ link.first_moment
    tensor = symmetric(to_world @ link.tensor @ to_world.T)
    x.sum("mass", link.mass)
    x.sum("moment", moment)
    x.sum("tensor", tensor)
    motion = BodyMotion(x.kept("omega"), x.kept("alpha"), x.kept("compensated"))
    # ċ = ω × c; ∫ c cᵀ dm = ½ tr(I) E - I
    spread = np.eye(3, dtype=object) * (np.trace(tensor) * 0.5) - tensor
    x.sum("impulse", cross(motion.omega, moment))
    x.sum("flow", np.array([cross(motion.omega, column) for column in spread.T], dtype=object).T)
    needed = inertial_wrench(replace(link, first_moment=moment, tensor=tensor), motion)
    external = x.external
    if external is not None:
        external = [(to_world @ force, to_world @ torque) for force, torque in external]
    x.sum("wrench", unloaded([needed], external)[0])


def gathered(x: BodyStep) -> None:
    """The sums are complete, and are added to those of the inside body."""
    arm, change = x.kept("arm"), x.kept("change")
    whole = composite(x)
    outside = whole.inwards(at_arm(arm))
    x.add("mass", outside.mass)
    x.add("moment", outside.first_moment)
    x.add("tensor", outside.tensor)
    # ċ grows by the velocity of the origin, c by the arm
    impulse = x.kept("impulse")
    x.add("impulse", impulse + change * whole.mass)
    x.add("flow", x.kept("flow") + np.outer(change, outside.first_moment) + np.outer(impulse, arm))
    x.add("wrench", shifted(x.kept("wrench"), arm))


def composite(x: BodyStep) -> Composite:
    """m, m c and I of the body and all bodies outside."""
    return Composite(x.kept("mass"), x.kept("moment"), x.kept("tensor"))


def shifted(wrench: Any, arm: Scalars) -> Wrench:
    """The same wrench about the origin of the inside body."""
    return inwards(at_arm(arm), (wrench[0], wrench[1]))


def per_rate(x: BodyStep) -> Wrench:
    """The momentum that a unit velocity of the joint gives, which is also what a unit acceleration takes."""
    p, outside = axis(x), composite(x)
    if x.prismatic:
        return p * outside.mass, cross(outside.first_moment, p)
    return cross(p, outside.first_moment), outside.tensor @ p


def along(x: BodyStep, wrench: Any) -> Any:
    """What of a wrench the joint feels."""
    return axis(x) @ wrench[0 if x.prismatic else 1]


BODIES = (Pass("ground", ground), Pass("outwards", moving), Pass("inwards", gathered))
"""What all steps need that ask for several bodies. What nobody reads is not computed."""
