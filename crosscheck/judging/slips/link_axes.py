"""Newton-Euler in link axes as people write it, its operations open to slips.

Luh, Walker and Paul, 1980; Craig, "Introduction to Robotics", section 6.5.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import Literal

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    joint_placement,
    turned,
    turned_back,
)
from crosscheck.judging.slips.body_wrenches import (
    ALPHA_ARM,
    ARM_FORCE,
    AT_THE_BASE,
    CROSS,
    INSIDE_UNTURNED,
    OF_THE_LINK,
    OMEGA_ARM,
    ONE_OMEGA,
    PASSED_FORCE,
    PASSED_MOMENT,
    PASSED_WRENCH,
    SLIDING,
    SPIN,
    SPIN_UP,
    SQUARED,
    TORQUE_ALONG_AXIS,
    WHOLE_ACCELERATION,
    BodyWrench,
    add_body,
)
from crosscheck.judging.slips.operations import NOT_TURNED, ONCE, WRONG_WAY, Operations, Product, turn_product
from graphdyn.layout import Array

Parts = tuple[list[Array], list[Array]]
"""Forces and moments of the joints, or of the bodies, about the link origins, in link axes (3, K, R)."""


@dataclass(frozen=True)
class LinkAxes:
    """Newton-Euler in link axes.

    gravity: an acceleration of the base, or turned from link to link beside the accelerations
    bodies: about the center of mass, or with first moments, about the link origin
    """

    gravity: Literal["of the base", "apart"] = "of the base"
    bodies: BodyWrench = add_body

    def __call__(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
        """Torques (n, K, R)."""
        turns, arms, forces, moments = self._outward(code, x, state, do)
        return _inward(code, x, do, (turns, arms), (forces, moments))

    def joint_wrenches(self, code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Parts:
        turns, arms, forces, moments = self._outward(code, x, state, do)
        _inward(code, x, do, (turns, arms), (forces, moments))
        return forces, moments

    def _outward(
        self, code: DynamicsCode, x: Numbers, state: State, do: Operations
    ) -> tuple[list[Array], list[Array], list[Array], list[Array]]:
        """Rotations and arms of the links, forces and moments of the bodies."""
        q, v, a = state
        zero = np.zeros((3, 1, 1))
        apart = self.gravity == "apart"
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
            turn, r = joint_placement(code, x, q, j)
            w, dw = omega[inside], alpha[inside]
            carried = do.outward("ω of the inside link", j, turn, w)
            spin = do.result(SPIN, j, 0.0 * p if slides else p * v[j])
            kept = do.result("ω of the inside link in that of the link", j, carried, {
                NOT_TURNED: lambda: 1.0 * w, WRONG_WAY: lambda: turned(turn, w),
            }, product=turn_product(turned_back, turn, w))  # fmt: skip
            omega.append(kept + spin)
            own_spin = 0.0 * p if slides else p * v[j]
            cross = do.result(CROSS, j, crossed(carried, own_spin), {
                INSIDE_UNTURNED: lambda: crossed(w, own_spin),
                "taken with ω of the inside link, turned the wrong way": lambda: crossed(turned(turn, w), own_spin),
            }, product=(crossed, {"ω": carried, "q̇ p": own_spin}))  # fmt: skip
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
            tangential = do.result(ALPHA_ARM, j, crossed(dw, r), others, product=(crossed, {"ω̇": dw, "r": r}))
            others = {
                NOT_TURNED: lambda: turned(turn, around),
                OF_THE_LINK.format("ω"): lambda: crossed(w_j, crossed(w_j, r)),
                "taken with ω turned too early": lambda: crossed(carried, crossed(carried, r)),
                "taken with r not turned": lambda: turned(turn, crossed(carried, crossed(carried, r))),
                "taken with r not turned and ω of the link": lambda: turned(turn, crossed(w_j, crossed(w_j, r))),
                ONE_OMEGA.format("ω × r"): lambda: crossed(w, r),
                SQUARED.format("r"): lambda: -(w * w).sum(axis=0) * r,
                "taken as (ω × ω) × r, zero": lambda: 0.0 * around,
            }
            product: Product = (crossed, {"the first ω": w, "ω × r": crossed(w, r)})
            moved = linear[inside] + tangential + do.result(OMEGA_ARM, j, around, others, product=product)
            alone = do.result(moved_name, j, linear[inside], {
                "not turned": lambda: turned(turn, linear[inside]),
                "turned the wrong way": lambda: turned(turn, turned(turn, linear[inside])),
            })  # fmt: skip
            moved = moved - linear[inside] + alone
            slide = p * v[j] if slides else 0.0 * p
            others = {INSIDE_UNTURNED: lambda: 2 * crossed(w, slide)}
            product = crossed, {"ω": 2 * carried, "ṡ": slide}
            sliding = do.result(SLIDING, j, 2 * crossed(carried, slide), others, product=product)
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
            product = turn_product(turned_back, turn, moved)
            moved_in = do.result(WHOLE_ACCELERATION, j, turned_back(turn, moved), {**whole, **in_part}, product=product)
            linear.append(moved_in + sliding + driven)
            gravity.append(do.outward("gravity", j, turn, gravity[inside]))
            c = x.centers[j]
            lever = do.result("c, in c × F,", j, c, {
                "turned into axes of the inside link": lambda: turned(turn, c),
                WRONG_WAY: lambda: turned_back(turn, c),
            })  # fmt: skip
            body = x.masses[j], c, lever, x.tensors[j]
            outer = [k for k, number in enumerate(code.inside) if number == j + 1]
            beyond = x.translations[outer[0]] if outer else zero
            self.bodies(j, inside, body, do, (omega, alpha, linear, gravity), (forces, moments), beyond)
            turns.append(turn)
            arms.append(r)
        return turns, arms, forces, moments


def _inward(code: DynamicsCode, x: Numbers, do: Operations, frames: Parts, wrenches: Parts) -> Array:
    """Torques; adds to the wrenches of the bodies those of the bodies outside. frames: rotations and arms"""
    (turns, arms), (forces, moments) = frames, wrenches
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
        }, product=turn_product(turned, turn, f))  # fmt: skip
        own = forces[i]
        others = {
            "taken with f not turned": lambda: crossed(r, f),
            "taken with f turned the wrong way": lambda: crossed(r, turned_back(turn, f)),
            "taken with the force of the inside link": lambda: crossed(r, own),
            "taken with the forces of both links": lambda: crossed(r, own + outer_force),
            "taken with c, not r": lambda: crossed(x.centers[i], outer_force),
            "taken with r − c, from the center of mass of the inside link": lambda: crossed(
                r - x.centers[i], outer_force
            ),
            "turned too early": lambda: turned(turn, crossed(r, f)),
            "taken with r turned, f not": lambda: crossed(turned(turn, r), f),
        }
        product = crossed, {"r": r, "f": outer_force}
        arm_force = do.result(ARM_FORCE, j, crossed(r, outer_force), others, product=product)
        moment = do.inward(PASSED_MOMENT, j, turn, n) + arm_force
        both = do.result(PASSED_WRENCH, j, np.stack(np.broadcast_arrays(passed, moment)), {
            WRONG_WAY: lambda: np.stack(np.broadcast_arrays(
                turned_back(turn, f), turned_back(turn, n) + crossed(r, turned_back(turn, f))
            )),
            "turned the wrong way, r × f not": lambda: np.stack(np.broadcast_arrays(
                turned_back(turn, f), turned_back(turn, n) + crossed(r, outer_force)
            )),
        }, product=turn_product(partial(_passed_on, r), turn, np.stack(np.broadcast_arrays(f, n))))  # fmt: skip
        forces[i], moments[i] = own + both[0], moments[i] + both[1]
    return np.stack(np.broadcast_arrays(*reversed(tau)))


def _passed_on(r: Array, turn: Array, wrench: Array) -> Array:
    """The wrench (2, 3, K, R) of the outer link, in axes of the inside one and about its origin."""
    f = turned(turn, wrench[0])
    return np.stack(np.broadcast_arrays(f, turned(turn, wrench[1]) + crossed(r, f)))


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
    found = do.result(TORQUE_ALONG_AXIS, j, (p * vector).sum(axis=0), {
        "taken as the third component, whatever the axis": lambda: 1.0 * vector[2],
        "taken with p turned by the joint's rotation": lambda: (turned(rotation, p) * vector).sum(axis=0),
        "taken with p turned into the inside link": lambda: (turned(turn, p) * vector).sum(axis=0),
        "taken about the origin of the inside link": lambda: (
            p * (f if slides else n + crossed(turned_back(turn, r), f))
        ).sum(axis=0),
        "taken about the origin of the inside link, its arm not turned by q": lambda: (
            p * (f if slides else n + crossed(fixed, f))
        ).sum(axis=0),
    })  # fmt: skip
    if not slides:
        return found
    others = {"taken of the moment n, as of a hinge": lambda: (p * n).sum(axis=0)}
    return do.result("the force p · f of sliding joints", j, found, others)
