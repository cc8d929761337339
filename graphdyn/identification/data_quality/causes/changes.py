"""Possible faults in the columns of a recording, and the changes that correct them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from graphdyn.display import short_repr
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
class RecordedColumns:
    """q = position c_q + zero,   tau = torque c_tau   with the columns c in SI units.

    position, torque: unit matrices if the columns are those of the joints          (n, n)
    zero: joint coordinates at zero of the position columns                         (n,) [rad or m]
    position_factor, torque_factor: by which the recorded numbers were multiplied, signs included; all alike if left out
        (n,)
    """

    position: Array
    torque: Array
    zero: Array
    position_factor: Array | None = None
    torque_factor: Array | None = None

    @classmethod
    def of_joints(cls, n: int) -> RecordedColumns:
        """Columns that are the joint coordinates themselves."""
        return cls(np.eye(n), np.eye(n), np.zeros(n))


def _conjugated(change: Array, to_joints: Array) -> Array:
    """The change of the columns, expressed in joint coordinates."""
    return np.asarray(to_joints @ change @ np.linalg.inv(to_joints))


ChangeKind = Literal[
    "reversed torque",
    "reversed position",
    "reversed joint",
    "exchanged torques",
    "exchanged positions",
    "exchanged joints",
    "all torques reversed",
    "all positions reversed",
    "degrees",
    "radians",
    "zero",
    "scaled torque",
    "late torque",
    "gear ratio",
    "coupled positions",
    "coupled joints",
    "time scale",
    "gravity",
    "gravity subtracted",
]

MAX_PAIRED_JOINTS = 10
"""Largest number of joints for which all pairs are tried as exchanged; beyond it only neighbors."""

MIN_EXPLAINED_SHARE = 0.3
"""Smallest share of a joint's torque that the model must explain for its gain to indicate a wrong unit."""

MIN_UNIT_GAIN = 2.0
"""Gain beyond which the unit is wrong: CAD is rarely so wrong."""

TRIAL_ZERO_OFFSETS = (90.0, -90.0, 180.0)
"""Zeros of angles that are tried [°]: those by which conventions differ."""


@dataclass(frozen=True, eq=False)
@short_repr
class Change:
    """A change of the columns that corrects a fault.

    joints: those that it concerns                          (k,)
    position, torque: factors of the columns, None for no change   (n, n)
    velocity: of those of v, and of a unless it has its own (n, n)
    zero: added to joint positions                          (n,) [rad]
    alone: position or velocity is changed without the other, because they contradict each other as recorded
    factor: of a scale; delay of the torque [s], of a lag
    acceleration: factors of the columns of a               (n, n)
    gravity: in place of that of the model, in world axes   (3,) [m/s²]
    """

    kind: ChangeKind
    joints: tuple[int, ...]
    position: Array | None = None
    velocity: Array | None = None
    torque: Array | None = None
    zero: Array | None = None
    alone: Literal["", "position", "velocity"] = ""
    factor: float = 1.0
    acceleration: Array | None = None
    gravity: Array | None = None

    @property
    def moves(self) -> bool:
        """Whether the equations change, with the motion or with gravity."""
        of_motion = (self.position, self.velocity, self.acceleration, self.zero, self.gravity)
        return any(part is not None for part in of_motion)

    def under_gravity(self, torque_model: TorqueModel) -> TorqueModel:
        """The torque model under the gravity of the change; itself for a change of columns."""
        if self.gravity is None:
            return torque_model
        return replace(torque_model, model=torque_model.model.with_gravity(self.gravity))

    def followed(self, kept: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Rows that count for each joint (N, n), after its standstill has moved to another column.

        A joint without any row that counts, whose torque is left out, keeps none, and passes that on to no other.
        """
        if self.velocity is None:
            return kept
        own, counts = np.arange(len(self.velocity)), np.asarray(kept.any(axis=0))
        largest = np.abs(self.velocity) >= np.abs(self.velocity).max(axis=1, keepdims=True)
        moved: NDArray[np.intp] = np.where(np.diag(largest), own, np.argmax(largest, axis=1))
        source: NDArray[np.intp] = np.where(counts[moved], moved, own)
        return np.asarray(kept[:, source] & counts)

    def applied(self, samples: Samples, columns: RecordedColumns) -> Samples:
        """The samples after the change of the columns."""
        q, v, a, tau = samples.q, samples.v, samples.a, samples.tau
        if self.position is not None:
            q = (q - columns.zero) @ _conjugated(self.position, columns.position).T + columns.zero
        if self.zero is not None:
            q = q + self.zero
        if self.velocity is not None:
            v = v @ _conjugated(self.velocity, columns.position).T
        of_a = self.velocity if self.acceleration is None else self.acceleration
        if of_a is not None:
            a = a @ _conjugated(of_a, columns.position).T
        if self.torque is not None:
            tau = tau @ _conjugated(self.torque, columns.torque).T
        return replace(samples, q=q, v=v, a=a, tau=tau)


def changes(
    slides: Sequence[bool], contradicting: Sequence[int] = (), columns: RecordedColumns | None = None
) -> Iterator[Change]:
    """All changes to try, the simpler first.

    slides: which joints are prismatic                      (n,)
    contradicting: joints whose v is not the rate of q; for them position or velocity alone may be changed
    columns: whose factors may stay with the joints when columns are exchanged
    """
    n = len(slides)
    turning = [j for j in range(n) if not slides[j]]
    for j in range(n):
        yield Change("reversed torque", (j,), torque=_signs(n, [j]))
    for j in range(n):
        yield from _reversed_positions(j, n, slides[j], contradicting)
    for pair in _pairs(n, slides):
        swap = _exchange(n, *pair)
        yield Change("exchanged torques", pair, torque=swap)
        yield Change("exchanged positions", pair, position=swap, velocity=swap)
        yield Change("exchanged joints", pair, position=swap, velocity=swap, torque=swap)
        if set(pair) & set(contradicting):
            yield Change("exchanged positions", pair, position=swap, alone="position")
            yield Change("exchanged positions", pair, velocity=swap, alone="velocity")
        if columns is not None:
            yield from _exchanged_alone(swap, pair, columns)
    for i, j in _pairs(n, slides):
        if j == i + 1:
            yield from _coupled(n, i, j)
            yield from _coupled(n, j, i)
    everywhere = -np.eye(n)
    yield Change("all torques reversed", tuple(range(n)), torque=everywhere)
    yield Change("all positions reversed", tuple(range(n)), position=everywhere, velocity=everywhere)
    yield from _angles(turning, n, contradicting)


def _exchanged_alone(swap: Array, pair: tuple[int, int], columns: RecordedColumns) -> Iterator[Change]:
    """Columns exchanged without their factors, where these differ: signs and gains belong to the joints."""
    q, tau = (_without_factors(swap, factor) for factor in (columns.position_factor, columns.torque_factor))
    if not np.array_equal(tau, swap):
        yield Change("exchanged torques", pair, torque=tau)
    if not np.array_equal(q, swap):
        yield Change("exchanged positions", pair, position=q, velocity=q)
    if not (np.array_equal(q, swap) and np.array_equal(tau, swap)):
        yield Change("exchanged joints", pair, position=q, velocity=q, torque=tau)


def _without_factors(swap: Array, factor: Array | None) -> Array:
    """The exchange of recorded numbers as one of SI values, F swap F⁻¹."""
    if factor is None or not np.all(factor != 0):
        return swap
    return np.asarray(swap * factor[:, None] / factor)


def scales(gain: Array, share: Array) -> Iterator[Change]:
    """Changes of unit: of all torques against the model, or of single joints against the others.

    The former shows only if some torques are known.

    gain: of measured on predicted torque (n,); share: of the torque that it explains (n,)
    """
    clear = np.flatnonzero((share >= MIN_EXPLAINED_SHARE) & (gain != 0))
    if not clear.size:
        return
    usual = float(np.median(np.abs(gain[clear])))
    if not 1 / MIN_UNIT_GAIN < usual < MIN_UNIT_GAIN:
        yield Change("scaled torque", tuple(range(len(gain))), torque=np.eye(len(gain)) / usual, factor=usual)
    for j in clear:
        size = abs(float(gain[j]))
        for factor in dict.fromkeys((size / usual, size)):
            if not 1 / MIN_UNIT_GAIN < factor < MIN_UNIT_GAIN:
                torque = np.eye(len(gain))
                torque[j, j] = 1 / factor
                yield Change("scaled torque", (int(j),), torque=torque, factor=factor)


def _reversed_positions(j: int, n: int, slides: bool, contradicting: Sequence[int]) -> Iterator[Change]:
    signs = _signs(n, [j])
    yield Change("reversed position", (j,), position=signs, velocity=signs)
    if j in contradicting:
        yield Change("reversed position", (j,), position=signs, alone="position")
        yield Change("reversed position", (j,), velocity=signs, alone="velocity")
    yield Change("reversed joint", (j,), position=signs, velocity=signs, torque=signs)
    if not slides:
        half = moved_zero(n, j, 180.0)
        yield Change("reversed position", (j,), position=signs, velocity=signs, zero=half)
        yield Change("reversed joint", (j,), position=signs, velocity=signs, torque=signs, zero=half)


def _angles(turning: Sequence[int], n: int, contradicting: Sequence[int]) -> Iterator[Change]:
    if not turning:
        return
    for kind, factor in (("degrees", np.pi / 180), ("radians", 180 / np.pi)):
        for j in turning:
            scale = np.eye(n)
            scale[j, j] = factor
            alone: Literal["", "position"] = "position" if j in contradicting else ""
            yield Change(kind, (j,), position=scale, velocity=None if alone else scale, alone=alone)  # type: ignore[arg-type]
        scale = np.eye(n)
        scale[turning, turning] = factor
        if set(contradicting) & set(turning):
            yield Change(kind, tuple(turning), position=scale, alone="position")  # type: ignore[arg-type]
        else:
            yield Change(kind, tuple(turning), position=scale, velocity=scale)  # type: ignore[arg-type]
    for j in turning:
        for degrees in TRIAL_ZERO_OFFSETS:
            yield Change("zero", (j,), zero=moved_zero(n, j, degrees))


def _pairs(n: int, slides: Sequence[bool]) -> Iterator[tuple[int, int]]:
    for i, j in combinations(range(n), 2):
        if slides[i] == slides[j] and (n <= MAX_PAIRED_JOINTS or j == i + 1):
            yield i, j


def _signs(n: int, joints: Sequence[int]) -> Array:
    signs = np.eye(n)
    signs[joints, joints] = -1.0
    return signs


def _coupled(n: int, driven: int, driving: int) -> Iterator[Change]:
    """A joint whose column is its angle to the link before last, or that turns with another joint's motor."""
    for factor in (1.0, -1.0):
        position = np.eye(n)
        position[driven, driving] = factor
        pair = (driven, driving)
        yield Change("coupled positions", pair, position=position, velocity=position, factor=factor)
        torque: Array = np.asarray(np.linalg.inv(position).T, dtype=float)
        yield Change("coupled joints", pair, position=position, velocity=position, torque=torque, factor=factor)


def _exchange(n: int, i: int, j: int) -> Array:
    order = np.arange(n)
    order[[i, j]] = j, i
    return np.eye(n)[order]


def moved_zero(n: int, j: int, degrees: float) -> Array:
    """The zero of one joint moved, for Change.zero (n,) [rad]."""
    zero = np.zeros(n)
    zero[j] = np.deg2rad(degrees)
    return zero
