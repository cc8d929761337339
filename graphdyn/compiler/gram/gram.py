"""Gram matrices of the torque equations of many samples, without the equations.

Per joint j, over all samples, [W_j | C_j | τ_j]ᵀ [W_j | C_j | τ_j] with W_j: row j of the joint-torque regressor, in
those of the chosen columns that can differ from zero; C_j: further columns of the joint (friction, offset); τ_j its
torque.
A Gram matrix squares the condition number: it is for motions that excite all parameters well.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from graphdyn.compiler.gram.code import COLUMN_STRIDE, emit_gram, products, tiles
from graphdyn.compiler.interpreter import Interpreter, together
from graphdyn.compiler.llvm.memory import address, aligned
from graphdyn.compiler.native import MachineCode, guard_memory, guards, host_lanes
from graphdyn.compiler.programs import record_equations
from graphdyn.compiler.running import MAX_COMPILED_LENGTH, beyond_reduction, chosen_backend, in_threads, turned_back
from graphdyn.display import short_repr
from graphdyn.layout import Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.scalars.expressions import MULTIPLIED_COLUMNS, Guard, Program

SAMPLES_PER_PORTION = 8192
"""Samples that are summed on their own, whatever the number of threads, so that the sums do not depend on it."""

TILE_OPERATIONS = 5
"""Operations that take as long to compile as the call that sums up a tile."""

MAX_TILE_LANES = 8
"""Lanes for which the tiles are counted, so that one model is compiled on every machine or on none."""

Seen = dict[Guard, float]


@dataclass(frozen=True, eq=False)
@short_repr
class TorqueGram:
    """Recorded and compiled once for a robot; call it with recordings.

    columns: per joint, positions among the chosen columns of those that can differ from zero in its equations
    n_extra: further columns of each joint
    """

    model: RobotModel
    columns: tuple[NDArray[np.intp], ...]
    n_extra: int
    _program: Program
    _backend: InterpretedGram | CompiledGram

    def __call__(
        self,
        q: Array,
        v: Array,
        a: Array,
        tau: Array,
        extra: Array,
        weights: Array | None = None,
        *,
        threads: int | None = None,
    ) -> tuple[list[Array], Seen]:
        """Gram matrices (m_j, m_j), m_j = len(columns[j]) + n_extra + 1, of arrays (N, n); extra (N, n, n_extra).

        weights: of the equations (N, n), for a TorqueGram that is weighted
        The second answer is what the guards found: "finite" is NaN if any argument is not finite, and then so are the
        sums.
        """
        arrays = {"q": q, "v": v, "a": a, "tau": tau, "extra": extra.reshape(len(q), self.model.nv * self.n_extra)}
        arrays |= {} if weights is None else {"weights": weights}
        inputs = {name: np.require(arrays[name], float, ["C", "ALIGNED"]) for name in self._program.inputs}
        matrices, seen = self._sum(inputs, threads)
        if beyond_reduction(self.model, q, seen):
            return self._sum({**inputs, "q": turned_back(self.model, inputs["q"])}, threads)
        return matrices, seen

    def _sum(self, inputs: Mapping[str, Array], threads: int | None) -> tuple[list[Array], Seen]:
        count = len(inputs["q"])
        portions = [
            (first, min(first + SAMPLES_PER_PORTION, count)) for first in range(0, max(count, 1), SAMPLES_PER_PORTION)
        ]
        parts = in_threads(self._backend.bind(inputs), portions, threads)
        total = np.add.reduce([sums for sums, _ in parts])
        return self._backend.matrices(total), together(self._program.guards, [seen for _, seen in parts])


def torque_gram(model: RobotModel, columns: Sequence[int], n_extra: int = 0, *, weighted: bool = False) -> TorqueGram:
    """Gram matrices of the equations of these columns of the joint-torque regressor."""
    program, used = record_equations(model, columns, n_extra, weighted)
    groups = [len(indices) + n_extra + 1 for indices in used]
    length = program.arithmetic + TILE_OPERATIONS * len(tiles(groups, MAX_TILE_LANES))
    kind = InterpretedGram if chosen_backend() == "numpy" or length > MAX_COMPILED_LENGTH else CompiledGram
    return TorqueGram(model, used, n_extra, program, kind(program, groups))


class InterpretedGram:
    """Sums on NumPy arrays, and their answers as those of CompiledGram."""

    def __init__(self, program: Program, groups: Sequence[int]) -> None:
        self._interpreter = Interpreter(program)
        self._groups = tuple(groups)
        self._ends = np.cumsum(groups).tolist()

    def bind(self, inputs: Mapping[str, Array]) -> Callable[[int, int], tuple[Array, Seen]]:
        """run(first, last): the sums over these rows of C-contiguous arrays (N, width), and what the guards found."""

        def run(first: int, last: int) -> tuple[Array, Seen]:
            equations = np.empty((last - first, self._ends[-1]))
            rows = {name: array[first:last] for name, array in inputs.items()}
            seen = self._interpreter.bind(rows, {MULTIPLIED_COLUMNS: equations})(0, last - first)
            # [W_j | C_j | τ_j] of each joint, then its Gram matrix
            blocks = np.split(equations, self._ends[:-1], axis=1)
            return np.concatenate([(block.T @ block).ravel() for block in blocks]), seen

        return run

    def matrices(self, sums: Array) -> list[Array]:
        """The Gram matrix of every group, from the sums of all rows: those of parts may be added."""
        ends = np.cumsum(np.square(self._groups))[:-1].tolist()
        return [part.reshape(size, size) for size, part in zip(self._groups, np.split(sums, ends), strict=True)]


class CompiledGram:
    """Sums in machine code."""

    def __init__(self, program: Program, groups: Sequence[int], lanes: int | None = None) -> None:
        self._program, self._groups = program, tuple(groups)
        self._blocks = [slice(first, last) for first, last in pairwise(np.cumsum([0, *groups]).tolist())]
        self.lanes = host_lanes() if lanes is None else lanes
        self._code = MachineCode(emit_gram(program, groups, self.lanes))
        self._products = np.array(products(groups, self.lanes))
        self._rest = InterpretedGram(program, groups)
        pointers = [ctypes.c_void_p] * (3 + len(program.inputs))
        prototype = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, *pointers)
        self._gram = self._code.function("gram", prototype)

    def bind(self, inputs: Mapping[str, Array]) -> Callable[[int, int], tuple[Array, Seen]]:
        addresses = [address(inputs[name]) for name in self._program.inputs]
        rest = self._rest.bind(inputs)

        def run(first: int, last: int) -> tuple[Array, Seen]:
            # machine code takes multiples of the lanes; the rows that are left are summed by NumPy, into the first lane
            whole = first + (last - first) // self.lanes * self.lanes
            sums, seen = self._whole(first, whole, addresses)
            if whole < last:
                more, seen_there = rest(whole, last)
                sums[:, 0] += self._spread_out(self._rest.matrices(more))[tuple(self._products.T)]
                seen = together(seen, [seen, seen_there])
            return sums, seen

        return run

    def matrices(self, sums: Array) -> list[Array]:
        width = sum(self._groups)
        everything = np.zeros((width, width))
        # each product once, all lanes together; the other triangle is the same
        left, right = self._products.T
        everything[left, right] = everything[right, left] = sums.sum(axis=1)
        return [everything[block, block] for block in self._blocks]

    def _spread_out(self, matrices: Sequence[Array]) -> Array:
        """A block-diagonal matrix of the matrices."""
        width = sum(self._groups)
        everything = np.zeros((width, width))
        for block, matrix in zip(self._blocks, matrices, strict=True):
            everything[block, block] = matrix
        return everything

    def _whole(self, first: int, last: int, addresses: Sequence[int]) -> tuple[Array, Seen]:
        """Over rows first … last - 1, a multiple of the lanes: the sums of each lane (products, lanes)."""
        guarded, sums = guard_memory(self.lanes), np.zeros((len(self._products), self.lanes))
        if first < last:
            scratch = aligned((sum(self._groups), COLUMN_STRIDE * self.lanes))
            self._gram(first, last, address(scratch), *addresses, address(sums), address(guarded))
        return sums, guards(self._program, guarded)
