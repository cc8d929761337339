"""Force and moment of one body as people write them, open to slips, and the names of operations of all recursions.

Luh, Walker and Paul, 1980; Craig, "Introduction to Robotics", section 6.5: about the center of mass. Khalil and Dombre,
"Modeling, Identification and Control of Robots", 2002, section 9.5.3: with first moments, about the link origin.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crosscheck.judging.faults.recursion import crossed, turned
from crosscheck.judging.slips.operations import Operations
from graphdyn.layout import Array

OF_THE_LINK = "taken with {} of the link, not of the inside one"
OF_THE_INSIDE = "taken with {} of the inside link"
INSIDE_UNTURNED = "taken with ω of the inside link, not turned"
PRINCIPAL_ALONE = "taken with the principal moments of J alone, without products of inertia"
ONE_OMEGA = "taken as {}, one ω× missing"
SQUARED = "taken as −ω² {}"

SPIN, SPIN_UP = "q̇ p in ω", "q̈ p in ω̇"
CROSS = "the term ω × q̇ p in ω̇"
ALPHA_ARM = "the term ω̇ × r in the acceleration of the link origin"
OMEGA_ARM = "the term ω × (ω × r) in the acceleration of the link origin"
SLIDING = "the term 2 ω × ṡ of sliding joints"
ALPHA_CENTER = "the term ω̇ × c in the acceleration of the center of mass"
OMEGA_CENTER = "the term ω × (ω × c) in the acceleration of the center of mass"
FORCE, WEIGHT = "the force m (a − g)", "the weight m g"
EULER, GYROSCOPIC = "the moment J ω̇", "the gyroscopic moment ω × J ω"
CENTER_FORCE = "the moment c × F of the link's force"
PASSED_FORCE, PASSED_MOMENT = "f of the outer link, passed on,", "n of the outer link, passed on,"
PASSED_WRENCH = "the wrench of the outer link, f and n, passed on,"
ARM_FORCE = "the moment r × f of the outer link's force"
TORQUE_ALONG_AXIS = "the torque p · n, or p · f where it slides,"
AT_THE_BASE = "gravity, as an acceleration of the base,"
WHOLE_ACCELERATION = "the whole acceleration of the joint"


Motions = tuple[list[Array], list[Array], list[Array], list[Array]]
"""ω, ω̇, the acceleration of the link origin and gravity, of the ground and of the links so far."""

BodyWrench = Callable[..., None]
"""add_body, or another way to write it."""


def add_body(
    j: int,
    inside: int,
    body: tuple[Array, Array, Array, Array],
    do: Operations,
    motions: Motions,
    wrenches: tuple[list[Array], list[Array]],
    beyond: Array | None = None,
) -> None:
    """Adds force and moment about its link origin, of the last link. body: mass, center in the accelerations and
    in the moment, tensor; beyond: from its link origin to the next joint"""
    omega, alpha, linear, gravity = motions
    mass, c, lever, tensor = body
    w, dw = omega[-1], alpha[-1]
    w_i, dw_i, a_o = omega[inside], alpha[inside], linear[-1]
    tangential = do.result(ALPHA_CENTER, j, crossed(dw, c), {OF_THE_INSIDE.format("ω̇"): lambda: crossed(dw_i, c)})
    centripetal = do.result(OMEGA_CENTER, j, crossed(w, crossed(w, c)), {
        OF_THE_INSIDE.format("ω"): lambda: crossed(w_i, crossed(w_i, c)),
        ONE_OMEGA.format("ω × c"): lambda: crossed(w, c),
        SQUARED.format("c"): lambda: -(w * w).sum(axis=0) * c,
    }, product=(crossed, {"the first ω": w, "ω × c": crossed(w, c)}))  # fmt: skip
    at_center = a_o + tangential + centripetal
    weight = do.result(WEIGHT, j, mass * gravity[-1])
    force = do.result(FORCE, j, mass * at_center - weight, {
        "taken with the acceleration of the link origin": lambda: mass * a_o - weight,
    })  # fmt: skip
    spun, diagonal = turned(tensor, w), tensor * np.eye(3).reshape(3, 3, *[1] * (tensor.ndim - 2))
    gyroscopic = do.result(GYROSCOPIC, j, crossed(w, spun), {
        "taken with ω of the inside link": lambda: crossed(w_i, turned(tensor, w_i)),
        "taken with ω of the inside link as its first factor": lambda: crossed(w_i, spun),
        "taken as ω × ω, without J": lambda: 0.0 * spun,
        PRINCIPAL_ALONE: lambda: crossed(w, turned(diagonal, w)),
        "taken as J (ω × ω̇)": lambda: turned(tensor, crossed(w, dw)),
        "taken as ω × J ω₁, with ω of the first link": lambda: crossed(w, turned(tensor, omega[1])),
    }, product=(crossed, {"ω": w, "J ω": spun}))  # fmt: skip
    euler = do.result(EULER, j, turned(tensor, dw), {
        OF_THE_INSIDE.format("ω̇"): lambda: turned(tensor, dw_i),
        PRINCIPAL_ALONE: lambda: turned(diagonal, dw),
    })  # fmt: skip
    others = {"taken with the acceleration of the link origin": lambda: crossed(lever, mass * a_o - weight)}
    others["taken of m a alone, without the weight"] = lambda: crossed(lever, mass * at_center)
    others["taken of the weight alone, without m a"] = lambda: crossed(lever, -weight)
    if beyond is not None:
        others["taken with r to the next joint, not c"] = lambda: crossed(beyond, force)
    turning = do.result(CENTER_FORCE, j, crossed(lever, force), others)
    wrenches[0].append(force)
    wrenches[1].append(euler + gyroscopic + turning)


FIRST_FORCE, FIRST_ALPHA = "m a in the force of the body", "ω̇ × m c in the force of the body"
FIRST_OMEGA = "ω × (ω × m c) in the force of the body"
EULER_AT_ORIGIN = "I ω̇, I about the link origin,"
GYROSCOPIC_AT_ORIGIN = "ω × I ω, I about the link origin,"
MOMENT_OF_WEIGHT = "m c × a in the moment of the body"


def add_body_with_first_moments(
    j: int,
    inside: int,
    body: tuple[Array, Array, Array, Array],
    do: Operations,
    motions: Motions,
    wrenches: tuple[list[Array], list[Array]],
    beyond: Array | None = None,
) -> None:
    """The same with m c and the tensor I about the link origin; linear in mass, first moment and I."""
    omega, alpha, linear, gravity = motions
    mass, c, _, tensor = body
    w, dw, pulled = omega[-1], alpha[-1], linear[-1] - gravity[-1]
    first = mass * c

    def spun(u: Array) -> Array:
        return turned(tensor, u) + crossed(first, crossed(u, c))

    force = do.result(FIRST_FORCE, j, mass * pulled)
    force = force + do.result(FIRST_ALPHA, j, crossed(dw, first))
    force = force + do.result(FIRST_OMEGA, j, crossed(w, crossed(w, first)), {
        ONE_OMEGA.format("ω × m c"): lambda: crossed(w, first),
    }, product=(crossed, {"the first ω": w, "ω × m c": crossed(w, first)}))  # fmt: skip
    moment = do.result(EULER_AT_ORIGIN, j, spun(dw), {
        "taken with J about the center of mass": lambda: turned(tensor, dw),
    })  # fmt: skip
    moment = moment + do.result(GYROSCOPIC_AT_ORIGIN, j, crossed(w, spun(w)), {
        "taken with J about the center of mass": lambda: crossed(w, turned(tensor, w)),
    }, product=(crossed, {"ω": w, "I ω": spun(w)}))  # fmt: skip
    moment = moment + do.result(MOMENT_OF_WEIGHT, j, crossed(first, pulled), {
        "taken without gravity": lambda: crossed(first, linear[-1]),
    })  # fmt: skip
    wrenches[0].append(force)
    wrenches[1].append(moment)
