"""Measured motion and torques as arrays, and the interface of the filter that they still have to pass.

Data in independent parts can be processed in other processes or on other machines. The results of the parts are merged
in a binary tree that the numbers of the parts fix. The merged result is therefore the same to the last bit, wherever
and in whatever order the parts are processed.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array


class RowFilter(Protocol):
    """A linear filter along the rows, the same for every column: low-pass, decimation, or a sequence of them.

    factor: of the rows 0, 1, 2, … every factor-th one is kept
    memory: number of rows before and after a row on which its filtered value depends
    """

    @property
    def factor(self) -> int: ...
    @property
    def memory(self) -> int: ...

    def __call__(self, columns: Array) -> Array:
        """Filtered rows: (N, k) → (⌈N / factor⌉, k). Raises InvalidInput for too few rows."""
        ...


def filtered_length(rows: int, row_filter: RowFilter | None) -> int:
    """Number of rows that a filter keeps."""
    return rows if row_filter is None else -(-rows // row_filter.factor)


@dataclass(frozen=True, eq=False)
@short_repr
class Samples:
    """One piece of a recording: N samples, evenly spaced and in order, of n joints.

    q, v, a: joint positions, velocities, accelerations     (N, n)  [rad or m, …/s, …/s²]
    tau: measured actuator torques or forces                (N, n)  [N m or N]
    base: prescribed motion of the base, at rest if left out
    row_filter: filter still to be applied to the torque and every column of the regressor; tau is then as measured
    continues: whether the first sample follows the last one of the previous piece, one period later; filters and
        correlations in time then continue across the border
    time: of every sample, for methods that simulate the motion and for drifts   (N,)  [s]
    temperature: of the drives, for drifts                  (N, n)  [°C]
    motion_covariance: of the errors of q, v and a of each joint in a row of the equations, after the filter; for
        methods that allow for them                         (n, 3, 3)

    Memory maps are kept as they are and read piece by piece. Raises InvalidInput if the shapes differ.
    """

    q: Array
    v: Array
    a: Array
    tau: Array
    base: BaseMotion | None = None
    row_filter: RowFilter | None = None
    continues: bool = False
    time: Array | None = None
    temperature: Array | None = None
    motion_covariance: Array | None = None

    def __post_init__(self) -> None:
        names = ("q", "v", "a", "tau", *(("temperature",) if self.temperature is not None else ()))
        arrays = {name: _two_dimensional(name, getattr(self, name)) for name in names}
        if len({array.shape for array in arrays.values()}) > 1:
            shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
            raise InvalidInput(f"the arrays of the samples differ in shape: {shapes}; all must be (N, n)")
        if self.base is not None and self.base.batch not in ((), (len(arrays["q"]),)):
            raise InvalidInput(f"the base motion has {self.base.batch} states for {len(arrays['q'])} samples")
        for name, array in arrays.items():
            object.__setattr__(self, name, array)
        if self.time is not None and np.shape(self.time) != (len(self),):
            raise InvalidInput(f"time of the samples has shape {np.shape(self.time)}, expected ({len(self)},)")
        expected = (self.q.shape[1], 3, 3)
        if self.motion_covariance is not None and np.shape(self.motion_covariance) != expected:
            given = np.shape(self.motion_covariance)
            raise InvalidInput(f"motion_covariance of the samples has shape {given}, expected {expected}")

    def __len__(self) -> int:
        return len(self.q)

    def __getitem__(self, rows: slice) -> Samples:
        parts = {name: getattr(self, name)[rows] for name in ("q", "v", "a", "tau")}
        parts |= {name: None if (x := getattr(self, name)) is None else x[rows] for name in ("time", "temperature")}
        continues = self.continues and not rows.start
        return dataclasses.replace(self, **parts, base=_base_rows(self.base, rows), continues=continues)

    def pieces(self, length: int) -> Iterator[Samples]:
        """Consecutive pieces of this length; the last one may be shorter."""
        for start in range(0, len(self), length):
            yield self[start : start + length]


def joined_samples(pieces: Sequence[Samples], rows: slice | NDArray[np.int64]) -> Samples:
    """These rows of several pieces as one piece with the base at rest."""

    def known(name: str) -> Array | None:
        columns = [getattr(piece, name) for piece in pieces]
        return None if any(column is None for column in columns) else np.concatenate(columns)[rows]

    q, v, a, tau = (np.concatenate([getattr(piece, name) for piece in pieces])[rows] for name in ("q", "v", "a", "tau"))
    return Samples(q, v, a, tau, time=known("time"), temperature=known("temperature"))


def _two_dimensional(name: str, value: ArrayLike) -> Array:
    array = value if isinstance(value, np.ndarray) else np.asarray(value)
    if array.ndim != 2 or array.dtype.kind not in "buif":
        raise InvalidInput(
            f"{name} of the samples must be real numbers of shape (N, n); it is {array.dtype} {array.shape}"
        )
    return array


def _base_rows(base: BaseMotion | None, rows: slice) -> BaseMotion | None:
    if base is None or base.batch == ():
        return base
    trailing = {"rotation": 2, "translation": 1, "velocity": 1, "acceleration": 1}
    parts = {name: getattr(base, name) for name in trailing}
    return dataclasses.replace(
        base, **{name: array[rows] if array.ndim > trailing[name] else array for name, array in parts.items()}
    )


class TorqueFreeSamples(Samples):
    """Samples whose torque cannot be read.

    A term that computed its columns from the measured torque would explain the torque by itself. Where a model is only
    evaluated, there is no measured torque.
    """

    def __init__(self, samples: Samples) -> None:
        self.__dict__.update(vars(samples))
        self.__dict__["_samples"] = samples

    @property
    def tau(self) -> Array:
        """Raises InvalidInput."""
        raise InvalidInput("a term reads samples.tau, the torque it is to explain; compute it from q, v and a alone")

    def __repr__(self) -> str:
        return f"TorqueFreeSamples(q={self.q!r}, v={self.v!r}, a={self.a!r}, base={self.base!r})"

    def __getitem__(self, rows: slice) -> TorqueFreeSamples:
        return TorqueFreeSamples(self.__dict__["_samples"][rows])


T = TypeVar("T")


@runtime_checkable
class Partitioned(Protocol):
    """Data in parts, for Problem(data=…) in place of samples; iterable, such as crosscheck.PartitionedRecording."""

    def each_part(self, problem: Any, function: Callable[[Any, slice], T]) -> list[tuple[int, T]]:
        """Number of the time block and result of every part, in their order.

        function: of the problem of one part and of which of its rows belong to it; the other rows are those around it
            that the row filter needs. It can be pickled
        """
        ...


def merged_in_tree(merge: Callable[[T, T], T], parts: Sequence[T]) -> T:
    """Sum of the parts in a binary tree: neighbors are merged, then neighboring pairs, and so on.

    A last part without a neighbor waits for the next round.
    """
    left = list(parts)
    while len(left) > 1:
        pairs = [merge(left[k], left[k + 1]) for k in range(0, len(left) - 1, 2)]
        left = pairs + left[2 * len(pairs) :]
    return left[0]
