"""Newton-Euler in world axes as people write it, its operations open to slips.

Siciliano et al., "Robotics: Modeling, Planning and Control", section 7.5, with all vectors in one system of axes.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

import numpy as np

from crosscheck.judging.faults.recursion import (
    DynamicsCode,
    Numbers,
    State,
    crossed,
    joint_placement,
    times,
    turned,
    turned_back,
)
from crosscheck.judging.slips.body_wrenches import (
    ALPHA_ARM,
    ARM_FORCE,
    CROSS,
    OF_THE_LINK,
    OMEGA_ARM,
    ONE_OMEGA,
    PASSED_FORCE,
    PASSED_MOMENT,
    SLIDING,
    SPIN,
    SPIN_UP,
    SQUARED,
    TORQUE_ALONG_AXIS,
    add_body,
)
from crosscheck.judging.slips.operations import NOT_TURNED, WRONG_WAY, Operations
from crosscheck.judging.slips.turning import tensor_in_world, ways_of_centers
from graphdyn.layout import Array


def world_axes(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """Newton-Euler in world axes."""
    q, v, a = state
    zero = np.zeros((3, 1, 1))
    attitude, omega, alpha, linear = [np.eye(3)[:, :, None, None]], [zero], [zero], [-x.gravity]
    at_zero, origins = [attitude[0]], [zero]
    arms: list[Array] = []
    axes: list[Array] = []
    forces: list[Array] = []
    moments: list[Array] = []
    for j, (inside, slides) in enumerate(zip(code.inside, code.prismatic, strict=True)):
        p = x.axes[j]
        turn, local = joint_placement(code, x, q, j)
        attitude.append(times(attitude[inside], turn))
        base, R = attitude[inside], attitude[-1]
        at_zero.append(times(at_zero[inside], x.rotations[j]))
        origins.append(origins[inside] + turned(base, local))
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
            SQUARED.format("r"): lambda: -(w * w).sum(axis=0) * r,
        })  # fmt: skip
        sliding = do.result(SLIDING, j, 2 * crossed(w, slide))
        driven = do.result("q̈ p of sliding joints in the acceleration", j, z * a[j] if slides else 0.0 * z)
        carried = do.result("the acceleration of the inside link's origin", j, linear[inside])
        linear.append(carried + tangential + around + sliding + driven)
        own_c, own_j = x.centers[j], x.tensors[j]
        ways = ways_of_centers(R, base, own_c)
        c = do.result("c in world axes", j, turned(R, own_c), ways)
        lever = do.result("c in world axes, in c × F,", j, c, ways)
        c = do.result("c in world axes, in the acceleration of the center of mass,", j, c, ways)
        tensor = tensor_in_world(j, R, base, own_j, do, at_zero=at_zero[-1])
        body = x.masses[j], c, lever, tensor
        add_body(j, inside, body, do, (omega, alpha, linear, [zero]), (forces, moments))
        axes.append(z)
    tau = []
    for j in reversed(range(len(code.inside))):
        z, f, n, o = axes[j], forces[j], moments[j], origins[j + 1]
        following = axes[min(j + 1, len(axes) - 1)]
        tau.append(do.result(TORQUE_ALONG_AXIS, j, (z * (f if code.prismatic[j] else n)).sum(axis=0), {
            "taken about the world's origin": lambda: (z * (f if code.prismatic[j] else n + crossed(o, f))).sum(axis=0),
            "taken along the axis of the next joint": lambda: (
                (following * (f if code.prismatic[j] else n)).sum(axis=0)
            ),
        }))  # fmt: skip
        i = code.inside[j] - 1
        if i < 0:
            continue
        own, r = forces[i], arms[j]
        others = {
            "taken with the force of the inside link": lambda: crossed(r, own),
            "taken with the forces of both links": lambda: crossed(r, own + f),
        }
        forces[i] = own + do.result(PASSED_FORCE, j, f)
        moments[i] = (
            moments[i] + do.result(PASSED_MOMENT, j, moments[j]) + do.result(ARM_FORCE, j, crossed(r, f), others)
        )
    return np.stack(np.broadcast_arrays(*reversed(tau)))
