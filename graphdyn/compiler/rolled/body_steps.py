"""Inverse and forward dynamics as steps of one body, which is a robot of one body on its inside body.

A step is given rolling.StepInputs: the link, its joint arrays and external wrench; the inside body as
a ground that moves; and memory: what earlier steps of the body kept, what bodies outside have added to its sums.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.recursions.forward import Inertia, SeenThroughJoint, accelerated, seen_through_joint
from graphdyn.recursions.inverse import Wrench, answers, inwards, unloaded
from graphdyn.recursions.motion import BodyMotion, JointPlacement, inertial_wrench, motions, places, rotations
from graphdyn.scalars.vectors import Scalars, symmetric


@dataclass(frozen=True)
class Pass:
    """A step for every body. outwards: inside bodies before those outside, or after

    step: answers columns of the outputs, by name
    """

    outwards: bool
    step: Callable[[Any], dict[str, list[Any]]]


def _placed(x: Any, acceleration: Any) -> BodyMotion:
    """How the body moves. This and where it is are kept, for bodies outside too, with the wrench that it takes."""
    (place,) = places([x.link], [x.joint("q")])
    (motion,) = motions([x.link], [place], x.ground, [x.joint("v")], [acceleration])
    (wrench,) = unloaded([inertial_wrench(x.link, motion)], x.external)
    # sine and cosine are computed on the way out alone, and read on the way in
    x.keep("turn", [place.c, place.s])
    for name in ("omega", "alpha", "compensated"):
        x.keep(name, getattr(motion, name))
    x.keep("wrench", wrench)
    if x.reactions:
        x.keep("rotation", rotations([x.link], [place], x.ground)[0])
    return motion


def _place(x: Any) -> JointPlacement:
    if x.link.prismatic:
        return places([x.link], [x.joint("q")])[0]
    c, s = x.kept("turn")
    return JointPlacement(x.link.rotation, c, s, x.link.translation)


def _motion(x: Any) -> BodyMotion:
    return BodyMotion(x.kept("omega"), x.kept("alpha"), x.kept("compensated"))


def _answers(x: Any, place: JointPlacement, motion: BodyMotion, wrench: Wrench) -> dict[str, list[Any]]:
    return answers([x.link], [place], x.ground, [motion], [wrench]) if x.reactions else {}


# Inverse dynamics


def _moving(x: Any) -> dict[str, list[Any]]:
    _placed(x, x.joint("a"))
    return {}


def _transmitted(x: Any) -> dict[str, list[Any]]:
    place, (force, moment) = _place(x), x.kept("wrench")
    # what the joint transmits loads the inside body: the sum over all bodies outside is complete here
    x.add("wrench", inwards(place, (force, moment)))
    tau = force[2] if x.link.prismatic else moment[2]
    return {"tau": [tau], **_answers(x, place, _motion(x), (force, moment))}


# Forward dynamics


def _at_rest(x: Any) -> dict[str, list[Any]]:
    _placed(x, 0.0)
    x.keep("inertia", _entries(Inertia.of(x.link)))
    return {}


def _eliminated(x: Any) -> dict[str, list[Any]]:
    place, inertia, (force, moment) = _place(x), _inertia(x.kept("inertia")), x.kept("wrench")
    # I^A and p^A are complete; I^a and p^a go to the inside body (graphdyn.recursions.forward)
    leaf = seen_through_joint(x.link.prismatic, inertia, (force, moment), x.joint("tau"))
    x.add("inertia", _entries(leaf.inertia.inwards(place)))
    x.add("wrench", inwards(place, leaf.bias))
    x.keep("U", leaf.U)
    x.keep("gain", [leaf.D_inverse, leaf.u])
    if x.reactions:  # the sums are done
        x.keep("inertia", _entries(leaf.inertia))
        x.keep("wrench", leaf.bias)
    pivot = inertia.m[2, 2] if x.link.prismatic else inertia.j[2, 2]
    return {"pivots": [pivot * x.pivot_scale]}


def _accelerated(x: Any) -> dict[str, list[Any]]:
    place, motion = _place(x), _motion(x)
    inertia, bias, U, gain = _inertia(x.kept("inertia")), x.kept("wrench"), x.kept("U"), x.kept("gain")
    leaf = SeenThroughJoint(inertia, (bias[0], bias[1]), (U[0], U[1]), *gain)
    a, (linear, angular), wrench = accelerated(x.link, place, leaf, (x.gained[0], x.gained[1]))
    x.keep("gained", (linear, angular))
    # the motion at a = 0 that the first pass kept, and what the accelerations add
    total = BodyMotion(motion.omega, motion.alpha + angular, motion.compensated + linear)
    return {"a": [a], **_answers(x, place, total, wrench)}


def _entries(inertia: Inertia) -> list[Any]:
    """The 21 that differ."""
    upper = np.triu_indices(3)
    return [*inertia.m[upper], *inertia.h.ravel(), *inertia.j[upper]]


def _inertia(entries: Scalars) -> Inertia:
    return Inertia(_symmetric(entries[:6]), entries[6:15].reshape(3, 3), _symmetric(entries[15:]))


def _symmetric(entries: Scalars) -> Scalars:
    matrix = np.empty((3, 3), dtype=object)
    matrix[np.triu_indices(3)] = entries
    return symmetric(matrix)


RECURSION_PASSES = {
    "inverse_dynamics": (Pass(True, _moving), Pass(False, _transmitted)),
    "forward_dynamics": (Pass(True, _at_rest), Pass(False, _eliminated), Pass(True, _accelerated)),
}
"""Passes by recursion."""

STEP_MEMORY = {
    "turn": (2,),
    "omega": (3,),
    "alpha": (3,),
    "compensated": (3,),
    "rotation": (3, 3),
    "wrench": (2, 3),
    "inertia": (21,),
    "U": (2, 3),
    "gain": (2,),
    "gained": (2, 3),
}
"""Shapes of what a step keeps."""

SUMMED_NAMES = ("wrench", "inertia")
"""Names to which bodies outside add while a pass goes inwards."""
