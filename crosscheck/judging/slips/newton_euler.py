"""Newton-Euler as people write it, in link axes and in world axes, its operations open to slips.

Luh, Walker and Paul, 1980; Craig, "Introduction to Robotics", section 6.5: in link axes. Siciliano et al., "Robotics:
Modeling, Planning and Control", section 7.5.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import combinations

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    times,
    turned,
    turned_about,
    turned_back,
)
from crosscheck.judging.slips.operations import NOT_TURNED, ONCE, WRONG_WAY, Operations
from graphdyn.layout import Array

OF_THE_LINK = "taken with {} of the link, not of the inside one"
OF_THE_INSIDE = "taken with {} of the inside link"
INSIDE_UNTURNED = "taken with ω of the inside link, not turned"
ONE_OMEGA = "taken as {}, one ω× missing"

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


def link_axes(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """Newton-Euler in link axes, gravity as an acceleration of the base."""
    return _link_axes(code, x, state, do, apart=False)[0]


def wrenches_in_link_axes(
    code: DynamicsCode, x: Numbers, state: State, do: Operations
) -> tuple[list[Array], list[Array]]:
    """Forces and moments of the joints about the link origins (3, K, R)."""
    return _link_axes(code, x, state, do, apart=False)[1]


def link_axes_weights(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """Newton-Euler in link axes, gravity turned from link to link beside the accelerations."""
    return _link_axes(code, x, state, do, apart=True)[0]


def _link_axes(
    code: DynamicsCode, x: Numbers, state: State, do: Operations, apart: bool
) -> tuple[Array, tuple[list[Array], list[Array]]]:
    """Torques, and forces and moments of the joints. apart: gravity beside the accelerations"""
    q, v, a = state
    zero = np.zeros((3, 1, 1))
    omega = [zero]
    pulled = zero if apart else -x.gravity
    nothing = 0 * pulled
    at_base = do.result(AT_THE_BASE, ONCE, np.stack([nothing, pulled]), {
        "taken as an angular acceleration": lambda: np.stack([pulled, nothing]),
    })  # fmt: skip
    alpha, linear, gravity = [at_base[0]], [at_base[1]], [x.gravity if apart else zero]
    moved_name = "the acceleration, without gravity," if apart else "the acceleration of the inside link's origin"
    turns: list[Array] = []
    arms: list[Array] = []
    forces: list[Array] = []
    moments: list[Array] = []
    for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
        p = x.axes[j]
        turn = x.rotations[j] if slides else times(x.rotations[j], turned_about(p, q[j]))
        r = x.translations[j] + (turned(x.rotations[j], p * q[j]) if slides else 0.0)
        w, dw = omega[inside], alpha[inside]
        carried = do.outward("ω of the inside link", j, turn, w)
        spin = do.result(SPIN, j, 0.0 * p if slides else p * v[j])
        kept = do.result("ω of the inside link in that of the link", j, carried, {
            NOT_TURNED: lambda: 1.0 * w, WRONG_WAY: lambda: turned(turn, w),
        })  # fmt: skip
        omega.append(kept + spin)
        own_spin = 0.0 * p if slides else p * v[j]
        cross = do.result(CROSS, j, crossed(carried, own_spin), {
            INSIDE_UNTURNED: lambda: crossed(w, own_spin),
            "taken with ω of the inside link, turned the wrong way": lambda: crossed(turned(turn, w), own_spin),
        })  # fmt: skip
        carried_up = do.outward("ω̇ of the inside link", j, turn, dw)
        alpha.append(carried_up + cross + do.result(SPIN_UP, j, 0.0 * p if slides else p * a[j]))
        w_j, dw_j = omega[-1], alpha[-1]
        around = crossed(w, crossed(w, r))
        others = {
            NOT_TURNED: lambda: turned(turn, crossed(dw, r)),
            OF_THE_LINK.format("ω̇"): lambda: crossed(dw_j, r),
            "taken with ω̇ turned too early": lambda: crossed(carried_up, r),
            "taken with r not turned": lambda: turned(turn, crossed(carried_up, r)),
            "taken with r not turned and ω̇ of the link": lambda: turned(turn, crossed(dw_j, r)),
        }
        tangential = do.result(ALPHA_ARM, j, crossed(dw, r), others)
        others = {
            NOT_TURNED: lambda: turned(turn, around),
            OF_THE_LINK.format("ω"): lambda: crossed(w_j, crossed(w_j, r)),
            "taken with ω turned too early": lambda: crossed(carried, crossed(carried, r)),
            "taken with r not turned": lambda: turned(turn, crossed(carried, crossed(carried, r))),
            "taken with r not turned and ω of the link": lambda: turned(turn, crossed(w_j, crossed(w_j, r))),
            ONE_OMEGA.format("ω × r"): lambda: crossed(w, r),
            "taken as (ω × ω) × r, zero": lambda: 0.0 * around,
        }
        moved = linear[inside] + tangential + do.result(OMEGA_ARM, j, around, others)
        alone = do.result(moved_name, j, linear[inside], {
            "not turned": lambda: turned(turn, linear[inside]),
            "turned the wrong way": lambda: turned(turn, turned(turn, linear[inside])),
        })  # fmt: skip
        moved = moved - linear[inside] + alone
        slide = p * v[j] if slides else 0.0 * p
        sliding = do.result(SLIDING, j, 2 * crossed(carried, slide), {INSIDE_UNTURNED: lambda: 2 * crossed(w, slide)})
        driven = do.result("q̈ p of sliding joints in the acceleration", j, p * a[j] if slides else 0.0 * p)
        parts = {"that of the inside link": alone, "ω̇ × r": tangential, "ω × (ω × r)": moved - alone - tangential}
        in_part = {
            f"turned but for {' and '.join(left)}": partial(_turned_in_part, turn, parts, left)
            for size in (1, 2) for left in combinations(parts, size)
        }  # fmt: skip
        whole: dict[str, Callable[[], Array]] = {
            NOT_TURNED: lambda: 1.0 * moved,
            WRONG_WAY: lambda: turned(turn, moved),
        }
        moved_in = do.result(WHOLE_ACCELERATION, j, turned_back(turn, moved), {**whole, **in_part})
        linear.append(moved_in + sliding + driven)
        gravity.append(do.outward("gravity", j, turn, gravity[inside]))
        body = x.masses[j], x.centers[j], x.centers[j], x.tensors[j]
        outer = [k for k, number in enumerate(code.inside) if number == j + 1]
        beyond = x.translations[outer[0]] if outer else zero
        _add_body(j, inside, body, do, (omega, alpha, linear, gravity), (forces, moments), beyond)
        turns.append(turn)
        arms.append(r)
    tau = []
    for j in reversed(range(len(code.inside))):
        f, n, turn, r = forces[j], moments[j], turns[j], arms[j]
        tau.append(
            _along_axis(j, (x.axes[j], x.rotations[j], x.translations[j]), (turn, r), (f, n), code.prismatic[j], do)
        )
        i = code.inside[j] - 1
        if i < 0:
            continue
        outer_force = do.inward("f of the outer link", j, turn, f)
        passed = do.result(PASSED_FORCE, j, outer_force, {
            NOT_TURNED: lambda: f + 0 * outer_force, WRONG_WAY: lambda: turned_back(turn, f),
        })  # fmt: skip
        own = forces[i]
        others = {
            "taken with f not turned": lambda: crossed(r, f),
            "taken with f turned the wrong way": lambda: crossed(r, turned_back(turn, f)),
            "taken with the force of the inside link": lambda: crossed(r, own),
            "taken with the forces of both links": lambda: crossed(r, own + outer_force),
            "taken with c, not r": lambda: crossed(x.centers[i], outer_force),
            "turned too early": lambda: turned(turn, crossed(r, f)),
            "taken with r turned, f not": lambda: crossed(turned(turn, r), f),
        }
        moment = do.inward(PASSED_MOMENT, j, turn, n) + do.result(ARM_FORCE, j, crossed(r, outer_force), others)
        both = do.result(PASSED_WRENCH, j, np.stack(np.broadcast_arrays(passed, moment)))
        forces[i], moments[i] = own + both[0], moments[i] + both[1]
    return np.stack(np.broadcast_arrays(*reversed(tau))), (forces, moments)


def _turned_in_part(turn: Array, parts: Mapping[str, Array], left: Sequence[str]) -> Array:
    """A sum of accelerations turned into the link, but for those that are left as they are."""
    done = [part if name in left else turned_back(turn, part) for name, part in parts.items()]
    return sum(done[1:], done[0])


def _along_axis(
    j: int,
    joint: tuple[Array, Array, Array],
    place: tuple[Array, Array],
    wrench: tuple[Array, Array],
    slides: bool,
    do: Operations,
) -> Array:
    """The torque of a joint. joint: axis, rotation and translation; place: of the link; wrench: force and moment."""
    (p, rotation, translation), (turn, r), (f, n) = joint, place, wrench
    fixed, vector = turned_back(rotation, translation), f if slides else n
    return do.result(TORQUE_ALONG_AXIS, j, (p * vector).sum(axis=0), {
        "taken with p turned by the joint's rotation": lambda: (turned(rotation, p) * vector).sum(axis=0),
        "taken with p turned into the inside link": lambda: (turned(turn, p) * vector).sum(axis=0),
        "taken about the origin of the inside link": lambda: (
            p * (f if slides else n + crossed(turned_back(turn, r), f))
        ).sum(axis=0),
        "taken about the origin of the inside link, its arm not turned by q": lambda: (
            p * (f if slides else n + crossed(fixed, f))
        ).sum(axis=0),
    })  # fmt: skip


Motions = tuple[list[Array], list[Array], list[Array], list[Array]]
"""ω, ω̇, the acceleration of the link origin and gravity, of the ground and of the links so far."""


def _add_body(
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
    })  # fmt: skip
    at_center = a_o + tangential + centripetal
    weight = do.result(WEIGHT, j, mass * gravity[-1])
    force = do.result(FORCE, j, mass * at_center - weight, {
        "taken with the acceleration of the link origin": lambda: mass * a_o - weight,
    })  # fmt: skip
    spun = turned(tensor, w)
    gyroscopic = do.result(GYROSCOPIC, j, crossed(w, spun), {
        "taken with ω of the inside link": lambda: crossed(w_i, turned(tensor, w_i)),
        "taken as ω × ω, without J": lambda: 0.0 * spun,
        "taken as J (ω × ω̇)": lambda: turned(tensor, crossed(w, dw)),
        "taken as ω × J ω₁, with ω of the first link": lambda: crossed(w, turned(tensor, omega[1])),
    })  # fmt: skip
    euler = do.result(EULER, j, turned(tensor, dw), {OF_THE_INSIDE.format("ω̇"): lambda: turned(tensor, dw_i)})
    others = {"taken with the acceleration of the link origin": lambda: crossed(lever, mass * a_o - weight)}
    if beyond is not None:
        others["taken with r to the next joint, not c"] = lambda: crossed(beyond, force)
    turning = do.result(CENTER_FORCE, j, crossed(lever, force), others)
    wrenches[0].append(force)
    wrenches[1].append(euler + gyroscopic + turning)


def world_axes(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """Newton-Euler in world axes."""
    q, v, a = state
    zero = np.zeros((3, 1, 1))
    attitude, omega, alpha, linear = [np.eye(3)[:, :, None, None]], [zero], [zero], [-x.gravity]
    arms: list[Array] = []
    axes: list[Array] = []
    forces: list[Array] = []
    moments: list[Array] = []
    for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
        p = x.axes[j]
        turn = x.rotations[j] if slides else times(x.rotations[j], turned_about(p, q[j]))
        attitude.append(times(attitude[inside], turn))
        base, R = attitude[inside], attitude[-1]
        local = x.translations[j] + (turned(x.rotations[j], p * q[j]) if slides else 0.0)
        ways = {
            NOT_TURNED: lambda: local + 0 * base[0], WRONG_WAY: lambda: turned_back(base, local),
            "turned with the outer link": lambda: turned(R, local),
        }  # fmt: skip
        r = do.result("r of the joint in world axes", j, turned(base, local), ways)
        arms.append(do.result("r of the joint in world axes, in r × f,", j, r, ways))
        r = do.result("r of the joint in world axes, in the accelerations,", j, r, ways)
        z = do.result("the joint axis in world axes", j, turned(R, p), {
            NOT_TURNED: lambda: p + 0 * R[0], WRONG_WAY: lambda: turned_back(R, p),
            "turned with the inside link": lambda: turned(base, p),
        })  # fmt: skip
        w, dw = omega[inside], alpha[inside]
        spin, slide = (0.0 * z, z * v[j]) if slides else (z * v[j], 0.0 * z)
        omega.append(do.result("ω of the inside link", j, w) + do.result(SPIN, j, spin))
        cross = do.result(CROSS, j, crossed(w, spin))
        up = do.result(SPIN_UP, j, 0.0 * z if slides else z * a[j])
        alpha.append(do.result("ω̇ of the inside link", j, dw) + cross + up)
        w_j, dw_j = omega[-1], alpha[-1]
        tangential = do.result(ALPHA_ARM, j, crossed(dw, r), {OF_THE_LINK.format("ω̇"): lambda: crossed(dw_j, r)})
        around = do.result(OMEGA_ARM, j, crossed(w, crossed(w, r)), {
            OF_THE_LINK.format("ω"): lambda: crossed(w_j, crossed(w_j, r)),
            ONE_OMEGA.format("ω × r"): lambda: crossed(w, r),
        })  # fmt: skip
        sliding = do.result(SLIDING, j, 2 * crossed(w, slide))
        driven = do.result("q̈ p of sliding joints in the acceleration", j, z * a[j] if slides else 0.0 * z)
        carried = do.result("the acceleration of the inside link's origin", j, linear[inside])
        linear.append(carried + tangential + around + sliding + driven)
        own_c, own_j = x.centers[j], x.tensors[j]
        ways = {
            NOT_TURNED: lambda: own_c + 0 * R[0], WRONG_WAY: lambda: turned_back(R, own_c),
            "turned with the inside link": lambda: turned(base, own_c),
        }  # fmt: skip
        c = do.result("c in world axes", j, turned(R, own_c), ways)
        lever = do.result("c in world axes, in c × F,", j, c, ways)
        c = do.result("c in world axes, in the acceleration of the center of mass,", j, c, ways)
        Rt = np.swapaxes(R, 0, 1)
        tensor = do.result("the tensor in world axes", j, times(times(R, own_j), Rt), {
            NOT_TURNED: lambda: own_j + 0 * R, WRONG_WAY: lambda: times(times(Rt, own_j), R),
            "turned with the inside link": lambda: times(times(base, own_j), np.swapaxes(base, 0, 1)),
            "taken as R J, the second R missing": lambda: times(R, own_j),
            "taken as R J R, not R J Rᵀ": lambda: times(times(R, own_j), R),
        })  # fmt: skip
        body = x.masses[j], c, lever, tensor
        _add_body(j, inside, body, do, (omega, alpha, linear, [zero]), (forces, moments))
        axes.append(z)
    tau = []
    for j in reversed(range(len(code.inside))):
        tau.append(
            do.result(TORQUE_ALONG_AXIS, j, (axes[j] * (forces[j] if code.prismatic[j] else moments[j])).sum(axis=0))
        )
        i = code.inside[j] - 1
        if i < 0:
            continue
        f, own, r = forces[j], forces[i], arms[j]
        others = {
            "taken with the force of the inside link": lambda: crossed(r, own),
            "taken with the forces of both links": lambda: crossed(r, own + f),
        }
        forces[i] = own + do.result(PASSED_FORCE, j, f)
        moments[i] = (
            moments[i] + do.result(PASSED_MOMENT, j, moments[j]) + do.result(ARM_FORCE, j, crossed(r, f), others)
        )
    return np.stack(np.broadcast_arrays(*reversed(tau)))
