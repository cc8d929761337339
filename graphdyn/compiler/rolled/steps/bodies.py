"""Inverse and forward dynamics as steps of one body, which is a robot of one body on its inside body.

A step is given a recording.BodyStep: the link, its joint arrays and external wrench; the memory of the inside body, or
of the ground that moves; and its own: what earlier steps of the body kept, what bodies outside have added to its sums.
All in joint axes, as in graphdyn.recursions, whose functions the steps call.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from graphdyn.compiler.rolled.program import Pass
from graphdyn.compiler.rolled.recording import BodyStep
from graphdyn.recursions.forward import Inertia, SeenThroughJoint, accelerated, seen_through_joint
from graphdyn.recursions.inverse import Wrench, answers, inwards, unloaded
from graphdyn.recursions.motion import (
    BodyMotion,
    JointPlacement,
    Root,
    inertial_wrench,
    motions,
    places,
    resting_root,
    rotations,
)
from graphdyn.scalars.vectors import Scalars, scalars, symmetric, zeros


def ground(x: BodyStep) -> None:
    """Place and motion of the ground frame."""
    for name in ("rotation", "omega", "alpha", "compensated"):
        x.keep(name, getattr(x.root, name))
    x.keep("gained", zeros(2, 3))


def _inside(x: BodyStep) -> Root:
    """The inside body as a ground that moves."""
    motion = {name: x.inside(name) for name in ("rotation", "omega", "alpha", "compensated")}
    return replace(resting_root(), gravity=scalars(x.model.gravity), **motion)


def _placed(x: BodyStep, acceleration: Any) -> None:
    """How the body moves. This and where it is are kept, for bodies outside too, with the wrench that it takes."""
    (place,) = places([x.link], [x.joint("q")])
    (motion,) = motions([x.link], [place], _inside(x), [x.joint("v")], [acceleration])
    ((force, moment),) = unloaded([inertial_wrench(x.link, motion)], None if x.external is None else x.external)
    # sine and cosine are computed on the way out alone, and read on the way in
    x.keep("turn", [place.c, place.s])
    for name in ("omega", "alpha", "compensated"):
        x.keep(name, getattr(motion, name))
    x.sum("wrench", (force, moment))
    if x.reactions:
        x.keep("rotation", rotations([x.link], [place], _inside(x))[0])


def place_of(x: BodyStep) -> JointPlacement:
    """The placement of the joint, of what the way out has kept."""
    if x.prismatic:
        return places([x.link], [x.joint("q")])[0]
    c, s = x.kept("turn")
    return JointPlacement(x.link.rotation, c, s, x.link.translation)


def _motion(x: BodyStep) -> BodyMotion:
    return BodyMotion(x.kept("omega"), x.kept("alpha"), x.kept("compensated"))


def _answer(x: BodyStep, place: JointPlacement, motion: BodyMotion, wrench: Wrench) -> None:
    if x.reactions:
        for name, values in answers([x.link], [place], _inside(x), [motion], [wrench]).items():
            x.answer(name, values)


# Inverse dynamics: Featherstone, "Rigid Body Dynamics Algorithms", 2008, table 5.1


def moving(x: BodyStep) -> None:
    _placed(x, x.joint("a"))


def transmitted(x: BodyStep) -> Any:
    """The torque of the joint, when all bodies outside have added what their joints transmit."""
    place, (force, moment) = place_of(x), x.kept("wrench")
    x.add("wrench", inwards(place, (force, moment)))
    _answer(x, place, _motion(x), (force, moment))
    return force[2] if x.prismatic else moment[2]


def _torque(x: BodyStep) -> None:
    tau = transmitted(x)
    x.answer(x.request.outputs[0] if x.request.recursion != "inverse_dynamics" else "tau", tau)


def _power(x: BodyStep) -> None:
    x.answer("power", transmitted(x) * x.joint("v"))


# Forward dynamics: the same, table 7.1


def at_rest(x: BodyStep) -> None:
    """The motion at a = 0; I^A and p^A of the body alone."""
    _placed(x, 0.0)
    x.sum("inertia", entries(Inertia.of(x.link)))


def eliminated(x: BodyStep) -> None:
    """I^A and p^A are complete; I^a and p^a go to the inside body (graphdyn.recursions.forward)."""
    place, inertia, (force, moment) = place_of(x), inertia_of(x.kept("inertia")), x.kept("wrench")
    leaf = seen_through_joint(x.prismatic, inertia, (force, moment), x.joint("tau"))
    x.add("inertia", entries(leaf.inertia.inwards(place)))
    x.add("wrench", inwards(place, leaf.bias))
    x.keep("seen_inertia", entries(leaf.inertia))
    x.keep("seen_wrench", leaf.bias)
    x.keep("U", leaf.U)
    x.keep("gain", [leaf.D_inverse, leaf.u])
    x.answer("pivots", (inertia.m[2, 2] if x.prismatic else inertia.j[2, 2]) * x.pivot_scale)


def accelerating(x: BodyStep) -> None:
    """The acceleration of the joint, when that of the inside body is known."""
    place, motion = place_of(x), _motion(x)
    (linear, angular), U, gain = x.inside("gained"), x.kept("U"), x.kept("gain")
    leaf = SeenThroughJoint(inertia_of(x.kept("seen_inertia")), tuple(x.kept("seen_wrench")), (U[0], U[1]), *gain)
    a, (linear, angular), wrench = accelerated(x.link, place, leaf, (linear, angular))
    x.keep("gained", (linear, angular))
    x.answer("a", a)
    # the motion at a = 0 that the first pass kept, and what the accelerations add
    total = BodyMotion(motion.omega, motion.alpha + angular, motion.compensated + linear)
    _answer(x, place, total, wrench)


def entries(inertia: Inertia) -> list[Any]:
    """The 21 that differ."""
    upper = np.triu_indices(3)
    return [*inertia.m[upper], *inertia.h.ravel(), *inertia.j[upper]]


def inertia_of(numbers: Scalars) -> Inertia:
    return Inertia(_symmetric(numbers[:6]), numbers[6:15].reshape(3, 3), _symmetric(numbers[15:]))


def _symmetric(numbers: Scalars) -> Scalars:
    matrix = np.empty((3, 3), dtype=object)
    matrix[np.triu_indices(3)] = numbers
    return symmetric(matrix)


def _inverse(last: Any) -> tuple[Pass, ...]:
    return Pass("ground", ground), Pass("outwards", moving), Pass("inwards", last)


FORWARD = (
    Pass("ground", ground),
    Pass("outwards", at_rest),
    Pass("inwards", eliminated),
    Pass("outwards", accelerating),
)

PASSES = {
    **{name: _inverse(_torque) for name in ("inverse_dynamics", "bias_torque", "gravity_torque", "static_torque")},
    "power": _inverse(_power),
    "forward_dynamics": FORWARD,
}
"""Passes by recursion. Torques of the bias, of gravity and of what is at rest are inverse dynamics of zeros."""
