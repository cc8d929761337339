"""Inverse dynamics by recursion: outwards the motion, inwards the wrenches. Luh, Walker and Paul, 1980."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root, inertial_wrench, motions, places
from graphdyn.kernels.reactions import Wrench, answers, transmitted


def inverse_dynamics(
    links: Sequence[Link],
    root: Root,
    q: Sequence[Any],
    v: Sequence[Any],
    a: Sequence[Any],
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """tau, body_accelerations, multipliers and joint_wrenches of graphdyn.inverse_dynamics."""
    at = places(links, q)
    moving = motions(links, at, root, v, a)
    wrenches = transmitted(links, at, [inertial_wrench(*pair) for pair in zip(links, moving, strict=True)], external)
    tau = [force[2] if link.prismatic else moment[2] for link, (force, moment) in zip(links, wrenches, strict=True)]
    return {"tau": tau, **answers(links, at, root, moving, wrenches)}


def power(
    links: Sequence[Link],
    root: Root,
    q: Sequence[Any],
    v: Sequence[Any],
    a: Sequence[Any],
    external: Sequence[Wrench] | None = None,
) -> list[Any]:
    """τ_j v_j (n)."""
    tau = inverse_dynamics(links, root, q, v, a, external)["tau"]
    return [torque * rate for torque, rate in zip(tau, v, strict=True)]
