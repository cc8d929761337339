"""Centers and tensors turned into world axes as people do it, open to slips."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import numpy as np

from crosscheck.judging.faults.recursion import times, turned, turned_back
from crosscheck.judging.slips.operations import NOT_TURNED, WRONG_WAY, Operations
from graphdyn.layout import Array

WITH_THE_OUTER = "turned with the outer link"
WITH_THE_INSIDE = "turned with the inside link"

Of = Literal["joint", "body"]


def center_in_world(name: str, b: int, R: Array, before: Array, c: Array, do: Operations, of: Of = "joint") -> Array:
    """R c. R, before: rotations of the link and of the inside one"""
    return do.result(name, b, turned(R, c), ways_of_centers(R, before, c), of=of)


def ways_of_centers(R: Array, before: Array, c: Array) -> dict[str, Callable[[], Array]]:
    """What else is done with c than turning it into world axes."""
    return {
        NOT_TURNED: lambda: c + 0 * R[0],
        WRONG_WAY: lambda: turned_back(R, c),
        WITH_THE_INSIDE: lambda: turned(before, c),
        "turned twice": lambda: turned(R, turned(R, c)),
    }


def tensor_in_world(
    b: int, R: Array, before: Array, J: Array, do: Operations, of: Of = "joint", at_zero: Array | None = None
) -> Array:
    """R J Rᵀ. at_zero: R at q = 0, where a code could have turned the tensor once"""
    Rt = np.swapaxes(R, 0, 1)
    diagonal = np.eye(3).reshape(3, 3, *[1] * (J.ndim - 2))
    once: dict[str, Callable[[], Array]] = {}
    if at_zero is not None:
        once["turned as at q = 0"] = lambda: times(times(at_zero, J), np.swapaxes(at_zero, 0, 1)) + 0 * R
    return do.result("the tensor in world axes", b, times(times(R, J), Rt), {
        **once,
        NOT_TURNED: lambda: J + 0 * R, WRONG_WAY: lambda: times(times(Rt, J), R),
        WITH_THE_INSIDE: lambda: times(times(before, J), np.swapaxes(before, 0, 1)),
        "taken as R J, the second R missing": lambda: times(R, J),
        "taken as R J R, not R J Rᵀ": lambda: times(times(R, J), R),
        "taken with the principal moments alone, products of inertia left out": lambda: (
            times(times(R, diagonal * J), Rt)
        ),
    }, of=of)  # fmt: skip
