"""Changes of a size that is to be found: the zero of a joint, a gear ratio, the unit of a torque, the clock.

The criterion Σ_j log ‖e_j‖ is computed at some sizes, by the fit without bounds (free_fit.py). Where that shows a
valley, the fit within bounds finds its bottom. The standard deviation is that of one Gauss-Newton step there, with
residuals that may be correlated within each of SIZE_BLOCKS time blocks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.identification.data_quality.causes.changes import Change, ChangeKind, moved_zero
from graphdyn.layout import Array

_ANGLES = (10.0, 20.0, 40.0, 60.0, 90.0, 135.0, 180.0)
TRIED_ZERO_OFFSETS = (*(-angle for angle in reversed(_ANGLES)), 0.0, *_ANGLES)
"""Zeros of angles to begin with [°]."""

FINE_ZERO_OFFSETS = (-4.0, -1.5, -0.5, 0.5, 1.5, 4.0)
"""Zeros for a recording that shows smaller ones: from any zero up to 10° one of them is nearer than no change [°]."""

TRIED_FACTORS = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.65, 2.0, 2.5, 3.3, 5.0)
"""Factors of a gear ratio or of a clock to begin with."""

FINE_FACTORS = (0.96, 0.985, 0.995, 1.005, 1.015, 1.04)
"""Factors for a recording that shows smaller ones."""

ROUND_ZERO_OFFSETS = (-180.0, -90.0, 90.0, 180.0)
"""Zeros by which conventions differ [°]."""

ROUND_FACTORS = (0.2, 0.25, 1 / 3, 0.5, 2 / 3, 1.5, 2.0, 3.0, 4.0, 5.0)
"""Ratios of small integers."""


@dataclass(frozen=True, eq=False)
class SizedChange:
    """A change whose size is to be found.

    tried: sizes to begin with, increasing, with `unchanged` among them   (k,)
    fine: sizes about `unchanged` for recordings that show smaller ones
    round_sizes: those that are likelier than any beside them
    unit: of the size, "°" or "" for a factor
    of: the change of a size
    """

    kind: ChangeKind
    joints: tuple[int, ...]
    tried: tuple[float, ...]
    fine: tuple[float, ...]
    unchanged: float
    round_sizes: tuple[float, ...]
    of: Callable[[float], Change]


def sized_changes(slides: Sequence[bool], contradicting: Sequence[int], clock: bool) -> Iterator[SizedChange]:
    """All changes of an unknown size.

    slides: which joints are prismatic                      (n,)
    contradicting: joints whose v is not the rate of q: only their positions have another ratio
    clock: whether v is the rate of q in all joints, so that another clock changes both
    """
    n = len(slides)
    for j in range(n):
        if not slides[j]:
            yield SizedChange("zero", (j,), TRIED_ZERO_OFFSETS, FINE_ZERO_OFFSETS, 0.0, ROUND_ZERO_OFFSETS, _zero(n, j))
    for j in range(n):
        if j in contradicting:
            continue
        yield SizedChange(
            "gear ratio", (j,), TRIED_FACTORS, FINE_FACTORS, 1.0, ROUND_FACTORS, _gear(n, j, with_torque=False)
        )
        yield SizedChange(
            "gear ratio", (j,), TRIED_FACTORS, FINE_FACTORS, 1.0, ROUND_FACTORS, _gear(n, j, with_torque=True)
        )
    for j in range(n):
        yield SizedChange("scaled torque", (j,), TRIED_FACTORS, FINE_FACTORS, 1.0, ROUND_FACTORS, _scale(n, j))
    if clock:
        yield SizedChange("time scale", tuple(range(n)), TRIED_FACTORS, FINE_FACTORS, 1.0, ROUND_FACTORS, _slower(n))


def _zero(n: int, j: int) -> Callable[[float], Change]:
    return lambda degrees: Change("zero", (j,), zero=moved_zero(n, j, degrees))


def _gear(n: int, j: int, *, with_torque: bool) -> Callable[[float], Change]:
    """The position multiplied by a factor, and the torque divided by it, as after a gear."""

    def change(factor: float) -> Change:
        position, torque = _factor(n, j, factor), _factor(n, j, 1 / factor) if with_torque else None
        return Change("gear ratio", (j,), position=position, velocity=position, torque=torque, factor=factor)

    return change


def _scale(n: int, j: int) -> Callable[[float], Change]:
    """A torque that was recorded multiplied by a factor."""
    return lambda factor: Change("scaled torque", (j,), torque=_factor(n, j, 1 / factor), factor=factor)


def _slower(n: int) -> Callable[[float], Change]:
    """Time stamps multiplied by a factor."""

    def change(factor: float) -> Change:
        rate = np.eye(n) / factor
        return Change("time scale", tuple(range(n)), velocity=rate, acceleration=rate / factor, factor=factor)

    return change


def _factor(n: int, j: int, factor: float) -> Array:
    matrix = np.eye(n)
    matrix[j, j] = factor
    return matrix
