"""Accelerations of short chains: M a = τ - h, with M by composite rigid bodies and h by inverse dynamics.

As many operations as the elimination of graphdyn.kernels.forward for six joints in a row, and more for longer chains.
But M and h are two sums that do not wait for each other, where the elimination is one: the longest sequence of
operations is shorter by a third.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from graphdyn.kernels.factorization import solved
from graphdyn.kernels.inverse import inverse_dynamics
from graphdyn.kernels.mechanism import Link
from graphdyn.kernels.motion import Root
from graphdyn.kernels.reactions import Wrench

SHORT = 6
"""Joints between a body and the ground. Measured: a fifth faster with six, equally fast with seven."""


def is_short(links: Sequence[Link]) -> bool:
    depths: list[int] = []
    for link in links:
        depths.append(1 + (depths[link.inside] if link.inside >= 0 else 0))
    return max(depths) <= SHORT


def joint_accelerations(
    links: Sequence[Link],
    root: Root,
    q: Sequence[Any],
    v: Sequence[Any],
    tau: Sequence[Any],
    external: Sequence[Wrench] | None = None,
) -> dict[str, list[Any]]:
    """a, and pivots: the inertia about each joint with all joints outside free to move."""
    bias = inverse_dynamics(links, root, q, v, [0.0] * len(links), external)["tau"]
    a, pivots = solved(links, q, [given - needed for given, needed in zip(tau, bias, strict=True)])
    return {"a": a, "pivots": pivots}
