"""An identification problem: the torque model and the recording, in time blocks.

The recording is read in pieces. Everything that least squares needs is kept in triangular factors, one set per time
block, so that cross-validation merges all but one. Only methods that use single samples read the recording again.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.algebra.accumulator import Accumulator, Compression
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE, BaseParameters, base_parameters
from graphdyn.identification.algebra.compressed import CompressedEquations, merged
from graphdyn.identification.algebra.least_squares import one_thread
from graphdyn.identification.data.rows import Rows, Run, counted, filtered, runs
from graphdyn.identification.data.samples import Partitioned, Samples, merged_in_tree
from graphdyn.identification.problem.prior import expected_equations, without_effect
from graphdyn.identification.problem.torque_model import DirectSums, ParameterStructure, TorqueModel, structure
from graphdyn.identification.terms.friction import positive
from graphdyn.layout import Array

DEFAULT_TIME_BLOCKS = 20
"""Default number of time blocks: in a recording of 80 correlation times each block has four, and standard
deviations from 20 blocks are known to 16 %."""

MAX_FOLDS = 10
"""Largest number of folds of a cross-validation; further time blocks are merged with their neighbors."""

CHUNK_SAMPLES = 1024
"""Samples whose regressor is in memory at once: 4 MB for a six-axis arm, and enough to be worth compiling for."""

MAX_CACHED_BYTES = 32e6
"""Default size of equations [bytes] up to which they are kept for the methods that read them many times."""

SUMMED_SAMPLES = 32768
"""Samples whose equations are summed up at once; of these only those of friction are in memory, 5 MB."""

NO_SAMPLES = (
    "the recording has no sample, or can be read only once and was: give the samples in a list, or an object that "
    "opens its file in __iter__"
)

Value = TypeVar("Value", bound=np.generic)
P = TypeVar("P", Rows, Rows | Samples)


@dataclass(frozen=True, eq=False)
@short_repr
class Problem:
    """A torque model and its data.

    data: one piece, several, or anything that can be iterated over repeatedly (a list; an object that
        opens its file in __iter__). Data that can be read only once (a generator) serve the methods that read once.
        Data in parts (graphdyn.identification.data.samples) are summed up part by part, wherever their parts are
    n_blocks: time blocks for standard deviations and cross-validation
    block_samples: samples per time block instead; required for data that can be read only once
    min_speed: equations of joint j with |v_j| below it are left out of the fit, one for all or (n,) [rad/s or m/s]
    compression: "qr", or "gram" for well-conditioned data
    rank_tolerance: smallest |R_kk| / |R_11| of the recording that counts as determined
    used: which rows count, of those that the filter keeps; all if left out. The filter runs over all of them, so that
        it has settled at the borders of the used rows; not for data in parts   (N,)
    progress: called with the number of samples of every chunk read
    cached_bytes: largest size of equations that are kept for methods that read them many times [bytes]
    """

    torque_model: TorqueModel
    data: Samples | Iterable[Samples]
    n_blocks: int = DEFAULT_TIME_BLOCKS
    block_samples: int | None = None
    min_speed: ArrayLike = 0.0
    compression: Compression = "qr"
    rank_tolerance: float = RANK_TOLERANCE
    used: NDArray[np.bool_] | None = None
    progress: Callable[[int], None] | None = None
    cached_bytes: float = MAX_CACHED_BYTES
    _memory: list[Rows] = field(default_factory=list, init=False, repr=False)

    def __post_init__(self) -> None:
        n = self.torque_model.model.nv
        speed = as_floats("min_speed", self.min_speed)
        if speed.shape not in ((), (n,)) or not np.all(speed >= 0):
            raise InvalidInput(f"min_speed is {speed}; give one speed ≥ 0, or {n}")
        if self.n_blocks < 1 or (self.block_samples is not None and self.block_samples < 1):
            raise InvalidInput(
                f"n_blocks is {self.n_blocks}, block_samples {self.block_samples}; both must be at least 1"
            )
        if self.used is not None and isinstance(self.data, Partitioned):
            raise InvalidInput("rows of data in parts cannot be chosen by `used`; give the data without the others")
        if not isinstance(self.data, Samples | Sequence) and iter(self.data) is self.data and not self.block_samples:
            raise InvalidInput("data that can be read only once need block_samples: their length is not known")

    @property
    def n_joints(self) -> int:
        """Number of joints of the robot that no others drive."""
        return self.torque_model.model.nv

    @cached_property
    def structure(self) -> ParameterStructure:
        """Parameters that some motion could determine."""
        return structure(self.torque_model)

    @cached_property
    def recorded(self) -> tuple[CompressedEquations, ...]:
        """Factors of every time block that has samples, in the base parameters of the structure."""
        if isinstance(self.data, Partitioned):
            return _blocks_of_parts(self.data.each_part(self, factors_of_part))
        blocks: dict[int, Accumulator] = defaultdict(self.accumulator)
        if self.compression == "gram":
            sums = DirectSums(self.torque_model, self.structure)
            for part, block in self._cut(counted(self._equations_or_samples(), self.used)):
                if isinstance(part, Samples):
                    kept = np.abs(part.v) >= self.min_speed
                    blocks[block].add_gram(sums(part, kept), kept.sum(axis=0))
                else:
                    blocks[block].add(part.matrix, part.right, kept=part.kept)
        else:
            for rows in self.rows():
                blocks[rows.block].add(rows.matrix, rows.right, kept=rows.kept)
        if not blocks:
            raise InvalidInput(NO_SAMPLES)
        return tuple(accumulator.compressed for _, accumulator in sorted(blocks.items()))

    def accumulator(self) -> Accumulator:
        """An empty accumulator for the equations of the structure."""
        n_joints, n_columns = self.structure.support.shape
        return Accumulator(n_columns, n_joints, support=self.structure.support, method=self.compression)

    @cached_property
    def inner(self) -> BaseParameters:
        """The structure's base parameters that the recording determines."""
        factors = merged(self.recorded).factors[..., :-1]
        return base_parameters(factors.reshape(-1, factors.shape[-1]), tolerance=self.rank_tolerance)

    @cached_property
    def base(self) -> BaseParameters:
        """Base parameters of this recording, in standard parameters."""
        if self.inner.rank == self.structure.base.rank:  # the same columns, but how clearly is up to the recording
            return replace(self.structure.base, gap=(self.inner.gap[0], self.structure.base.gap[1]))
        return self.structure.base.then(self.inner)

    @property
    def support(self) -> NDArray[np.bool_]:
        """Whether each base parameter of the recording can act on each joint (n, r)."""
        return self.structure.support[:, self.inner.independent]

    @cached_property
    def blocks(self) -> tuple[CompressedEquations, ...]:
        """Factors of every time block, in the base parameters of the recording."""
        parts = (part.selected(self.inner.independent) for part in self.recorded)
        given = self.torque_model.noise
        noise = None if given is None else positive("noise of the torques", given, self.n_joints)
        expected = expected_equations(self.torque_model, self.base)
        return tuple(replace(part, expected=expected, noise=noise) for part in parts)

    @property
    def without_effect(self) -> tuple[str, ...]:
        """Symbols of expected parameters that the recording determines only in sums, if at all."""
        return without_effect(self.torque_model, self.base)

    @cached_property
    def equations(self) -> CompressedEquations:
        """Factors of the whole recording, in the base parameters of the recording."""
        with one_thread():
            return merged(self.blocks)

    @cached_property
    def condition_number(self) -> float:
        """Condition number of the regressor, joints weighted by their measured torque and columns at unit length."""
        return float(np.linalg.cond(self.equations.unit_regressor)) if self.base.rank else 1.0

    @cached_property
    def folds(self) -> tuple[CompressedEquations, ...]:
        """The time blocks for cross-validation, merged with their neighbors to at most MAX_FOLDS."""
        return together(self.blocks)

    def standard_equations(self, noise: Array) -> tuple[Array, Array]:
        """R (r + 1, p), z (r + 1,) in all p parameters x: ‖R x - z‖² = Σ_g ‖W_g x - τ_g‖² / noise_g²."""
        r, z = self.equations.weighted(noise)
        return r @ self.base.matrix, z

    def part(self, used: NDArray[np.bool_]) -> Problem:
        """The same problem with only some of its rows (N,), filtered as before."""
        found = replace(self, used=used)
        if self.used is None and self._memory:
            found._memory.extend(replace(rows, block=block) for rows, block in found._cut(counted(self._memory, used)))
        return found

    def chosen(self, values: NDArray[Value]) -> NDArray[Value]:
        """The rows that count, from values for each row that the filter keeps (N, …)."""
        return values if self.used is None else values[self.used]

    def reduced(self, rows: Rows) -> Array:
        """Regressor W (N, n, r) of the base parameters of the recording."""
        return rows.matrix[..., self.inner.independent]

    def rows(self) -> Iterator[Rows]:
        """The equations, chunk by chunk; a chunk belongs to one time block. Few equations are kept in memory."""
        if self._memory:
            yield from self._memory
            return
        size, few = 0, list[Rows]()
        for part, block in self._cut(counted(self._equations(), self.used)):
            rows = replace(part, block=block)
            size += rows.matrix.nbytes
            few = [*few, rows] if size <= self.cached_bytes else []
            yield rows
        if not size:
            raise InvalidInput(NO_SAMPLES)
        self._memory.extend(few)

    def _cut(self, parts: Iterable[P]) -> Iterator[tuple[P, int]]:
        """Parts of the recording cut at the borders of the time blocks, and the number of their block."""
        position = 0
        for part in parts:
            start = 0
            while start < len(part):
                block, within = divmod(position, self._block_samples)
                cut = part[start : start + self._block_samples - within]
                yield cut, block
                start, position = start + len(cut), position + len(cut)

    def _equations(self) -> Iterator[Rows]:
        for run in self._runs():
            yield from self._equations_of(run)

    def _equations_or_samples(self) -> Iterator[Rows | Samples]:
        """The samples if no filter precedes their sums, otherwise the filtered equations."""
        for run in self._runs():
            if run.row_filter is None and not self.torque_model.has_memory:
                yield from map(self._told, run.pieces(SUMMED_SAMPLES))
            else:
                yield from self._equations_of(run)

    def _equations_of(self, run: Run) -> Iterator[Rows]:
        chunks = map(self._unfiltered, run.pieces(sys.maxsize if self.torque_model.has_memory else CHUNK_SAMPLES))
        if run.row_filter is not None:
            yield from filtered(chunks, run.row_filter, self.structure.support, self.min_speed)
            return
        for number, rows in enumerate(chunks):
            yield replace(rows, first=number == 0)

    def _unfiltered(self, samples: Samples) -> Rows:
        self._told(samples)
        matrix = self.torque_model.rows(samples, self.structure.base.independent)
        measured, velocity = np.asarray(samples.tau, dtype=float), np.asarray(samples.v, dtype=float)
        right = measured - self.torque_model.known_torque(samples)
        return Rows(matrix, right, measured, velocity, np.abs(velocity) >= self.min_speed)

    def _told(self, samples: Samples) -> Samples:
        if self.progress is not None:
            self.progress(len(samples))
        return samples

    def _runs(self) -> Iterator[Run]:
        """Runs of the data. Raises InvalidInput for data that are no pieces, or of other joints."""
        return runs(self._checked(piece) for piece in pieces_of(self.data))

    def _checked(self, piece: Samples) -> Samples:
        if not isinstance(piece, Samples):
            raise InvalidInput(f"the data hold a {type(piece).__name__}; every piece must be Samples(q, v, a, tau)")
        if piece.continues and self.torque_model.has_memory:
            raise InvalidInput("friction with memory needs each run of the recording as one piece; read it as a whole")
        if piece.q.shape[1] != self.n_joints:
            raise InvalidInput(
                f"the samples have {piece.q.shape[1]} joints, robot '{self.torque_model.model.name}' has "
                f"{self.n_joints}: {', '.join(self.torque_model.model.independent_joints)}"
            )
        return piece

    @cached_property
    def _block_samples(self) -> int:
        """Number of rows per time block."""
        if self.block_samples is not None:
            return self.block_samples
        if self.used is not None:
            return max(1, -(-int(np.count_nonzero(self.used)) // self.n_blocks))
        return max(1, -(-sum(run.filtered_length() for run in self._runs()) // self.n_blocks))


def pieces_of(data: Samples | Iterable[Samples]) -> Iterable[Samples]:
    """The data as pieces."""
    return [data] if isinstance(data, Samples) else data


def own_rows(problem: Problem, own: slice) -> Iterator[Rows]:
    """The equations of a part without those around it. own: start and stop among those that the filter keeps."""
    position = 0
    for rows in problem.rows():
        cut = rows[max(own.start - position, 0) : max(own.stop - position, 0)]
        position += len(rows)
        if len(cut):
            yield cut


def factors_of_part(problem: Problem, own: slice) -> CompressedEquations:
    """Factors of the own equations of a part."""
    with one_thread():
        if all(piece.row_filter is None for piece in pieces_of(problem.data)):
            return merged(problem.recorded)
        accumulator = problem.accumulator()
        for rows in own_rows(problem, own):
            accumulator.add(rows.matrix, rows.right, kept=rows.kept)
        return accumulator.compressed


def _blocks_of_parts(parts: Sequence[tuple[int, CompressedEquations]]) -> tuple[CompressedEquations, ...]:
    blocks: dict[int, list[CompressedEquations]] = defaultdict(list)
    for block, part in parts:
        blocks[block].append(part)
    with one_thread():
        return tuple(merged_in_tree(lambda one, other: merged([one, other]), blocks[block]) for block in sorted(blocks))


def together(blocks: Sequence[CompressedEquations]) -> tuple[CompressedEquations, ...]:
    """Time blocks merged with their neighbors to at most MAX_FOLDS."""
    length = -(-len(blocks) // MAX_FOLDS)
    return tuple(merged(blocks[start : start + length]) for start in range(0, len(blocks), length))
