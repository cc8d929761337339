"""Wrong signs: of positions, velocities, accelerations and torques, of products of inertia and centers of mass."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from crosscheck.judging.faults.fault import CodeFault, joints_said, of_bodies
from crosscheck.judging.faults.recursion import DynamicsCode
from graphdyn import RobotModel

MAX_SUBSET_JOINTS = 7
"""Largest number of joints for which every set of joints is tried (2^n); beyond, single joints and all."""

AXIS: Signs = (-1, -1, -1, -1)
"""Signs of q, v, a and τ: the axis points the other way."""

EVERY_SIGN: list[Signs] = [(a, b, c, d) for a, b, c, d in itertools.product((1, -1), repeat=4)]

SIGNED_QUANTITIES = ("position", "velocity", "acceleration", "torque")

Signs = tuple[int, int, int, int]

PATTERNS: dict[Signs, str] = {
    signs: f"the {' and '.join(named)} of {{who}} {'is' if len(named) == 1 else 'are'} taken with the opposite sign"
    for signs in EVERY_SIGN
    if (named := [name for name, sign in zip(SIGNED_QUANTITIES, signs, strict=True) if sign < 0])
} | {
    AXIS: "the axis of {who} points the other way",
    (1, 1, 1, -1): "the torque of {who} has the opposite sign",
    (-1, -1, -1, 1): "the motion of {who} is taken with the opposite sign, its torque is not",
    (1, -1, -1, -1): "velocity, acceleration and torque of {who} are taken with the opposite sign, its position is not",
}
"""What it means to reverse some of q, v, a, τ of a joint."""

SIGN_REMEDIES = {
    AXIS: "reverse the axis, or negate position, velocity, acceleration and torque of the joint",
    (1, 1, 1, -1): "negate it",
}

IN_SETS = (AXIS, (1, 1, 1, -1), (-1, -1, -1, 1), (1, -1, -1, -1), (-1, 1, 1, 1))
"""What happens to several joints at once: codes that take axes as positive reverse the others in part."""

OF_ALL = (AXIS, (-1, 1, 1, 1), (1, 1, -1, 1), (-1, -1, -1, 1), (1, -1, -1, -1))
"""What happens to all joints at once; torques are even in the velocities of all, and their own sign is
distinguished."""


def signs(model: RobotModel) -> Iterator[CodeFault]:
    every = list(range(model.n_bodies))
    for pattern in PATTERNS:
        size = 1 if pattern in IN_SETS or pattern.count(-1) == 1 else 2
        for joints in ([k] for k in every):
            yield _reversed(model, pattern, joints, size)
        if model.n_bodies > 1 and pattern in OF_ALL:
            yield _reversed(model, pattern, every, model.n_bodies)
    negated = partial(DynamicsCode.giving, answer=lambda tau, _: -tau)
    yield CodeFault.of("sign", "all torques have the opposite sign", "negate the result", negated)
    for pattern in IN_SETS:
        for joints in _several(model.n_bodies):
            yield _reversed(model, pattern, joints, size=len(joints))
    yield from of_bodies(
        model,
        "sign",
        "a tensor holds I_xy = -∫xy dm; some programs print +∫xy dm",
        {
            "the products of inertia of {who} have the opposite sign": lambda x, k: {
                "tensors": 2 * np.diag(np.diag(x.tensors[k])) - x.tensors[k]
            }
        },
    )
    opposite = "the center of mass of {who} lies on the other side of the link origin"
    yield from of_bodies(model, "sign", "negate it", {opposite: lambda x, k: {"centers": -x.centers[k]}})


def _reversed(model: RobotModel, pattern: Signs, joints: Sequence[int], size: int) -> CodeFault:
    signs = np.ones((len(pattern), model.n_bodies))
    signs[:, joints] = np.array(pattern)[:, None]
    s_q, s_v, s_a, s_tau = signs

    def change(code: DynamicsCode) -> DynamicsCode:
        if pattern == AXIS:
            return code.but(axes=s_q[:, None] * code.numbers.axes)
        code = code.taking(lambda q, v, a: (s_q * q, s_v * v, s_a * a))
        return code.giving(lambda tau, _: s_tau * tau) if (s_tau < 0).any() else code

    remedy = SIGN_REMEDIES.get(pattern, "use one sense for position, velocity, acceleration and torque of a joint")
    return CodeFault.of("sign", PATTERNS[pattern].format(who=joints_said(model, joints)), remedy, change, size)


def _several(n: int) -> Iterator[list[int]]:
    """Sets of two and more joints, without that of all."""
    for size in range(2, n) if n <= MAX_SUBSET_JOINTS else ():
        yield from map(list, itertools.combinations(range(n), size))
