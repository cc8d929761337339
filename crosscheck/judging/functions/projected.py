"""Torques by projection: the wrench of every body, times the Jacobian of its link, its operations open to slips.

Hutter, Gehring, Höpflinger, Blösch and Siegwart, "Toward combining speed, efficiency, versatility, and robustness in an
autonomous quadruped", 2014; the projected Newton-Euler equations.
"""

# ruff: noqa: B023 - the functions are called before the next joint

from __future__ import annotations

import numpy as np

from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, State, crossed, turned, turned_back
from crosscheck.judging.functions.motions import motions, stacked
from crosscheck.judging.functions.regressed import in_link_axes
from crosscheck.judging.slips.body_wrenches import add_body_with_first_moments
from crosscheck.judging.slips.operations import NOT_TURNED, WRONG_WAY, Operations
from graphdyn import Placement
from graphdyn.layout import Array


def projected(code: DynamicsCode, x: Numbers, state: State, do: Operations) -> Array:
    """Σ J_vᵀ f + J_ωᵀ n over the bodies, forces and moments about the link origins (n, K, R)."""
    m = motions(code, x, state, do, Placement())
    torque: list[Array] = [np.zeros((1, 1))] * len(code.inside)
    zero = np.zeros((3, 1, 1))
    after = [next((k for k, i in enumerate(code.inside) if i == j + 1), j) for j in range(len(code.inside))]
    for b, inside in enumerate(code.inside):
        R = m.rotations[b + 1]
        own: tuple[list[Array], list[Array]] = [], []
        w, dw, a = in_link_axes(m, b, x.gravity, do)
        body = x.masses[b], x.centers[b], x.centers[b], x.tensors[b]
        add_body_with_first_moments(b, 0, body, do, ([w], [dw], [a], [zero]), own)
        f, n = own[0][0], own[1][0]
        pair = do.result("the wrench of the body, turned into world axes,", b, _pair(turned(R, f), turned(R, n)), {
            NOT_TURNED: lambda: _pair(f + 0 * R[0], n + 0 * R[0]),
            WRONG_WAY: lambda: _pair(turned_back(R, f), turned_back(R, n)),
        }, of="body")  # fmt: skip
        place = do.result("the point at which the wrench of the body acts", b, m.origins[b + 1], {
            "the origin of the inside link": lambda: m.origins[inside] + 0 * m.origins[b + 1],
            "the center of mass": lambda: m.origins[b + 1] + turned(R, x.centers[b]),
        }, of="body")  # fmt: skip
        for j in m.chain(b + 1):
            z, o = m.axes[j], m.origins[j + 1]
            arm = crossed(place - o, pair[0])
            lever = do.result("r × f, r from the joint to the body,", j, arm, {
                "taken with the origin of the joint's inside link": lambda: crossed(
                    place - m.origins[code.inside[j]], pair[0]
                ),
                "taken with the origin of the next joint": lambda: crossed(place - m.origins[after[j] + 1], pair[0]),
            })  # fmt: skip
            part = (z * (pair[0] if code.prismatic[j] else pair[1] + lever)).sum(axis=0)
            torque[j] = torque[j] + (do.result("the part of its own body in a torque", j, part) if j == b else part)
    return stacked(torque)


def _pair(force: Array, moment: Array) -> Array:
    return np.stack(np.broadcast_arrays(force, moment))
