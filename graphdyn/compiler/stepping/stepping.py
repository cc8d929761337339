"""Whole simulations in compiled code: blocks of as many robots as lanes."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from graphdyn.compiler.llvm.memory import aligned
from graphdyn.compiler.native import MachineCode, host_lanes
from graphdyn.compiler.stepping.code import emit_steps
from graphdyn.compiler.stepping.layout import StepCode, places
from graphdyn.layout import Array


@dataclass(frozen=True)
class StepRange:
    """Steps start … start + count - 1, of width h [s]; a new torque at every hold-th, a record at every every-th."""

    start: int
    count: int
    every: int
    hold: int
    h: float

    @property
    def first_tick(self) -> int:
        """Number of the torque in force at the first step."""
        return self.start // self.hold

    @property
    def ticks(self) -> int:
        return (self.start + self.count - 1) // self.hold - self.first_tick + 1

    @property
    def records(self) -> int:
        return -(-(self.start + self.count) // self.every) - -(-self.start // self.every)


Otherwise = Callable[[int, int, int], None]
"""Takes a step of this number of a lane of a block that compiled code has left undone."""


class CompiledSteps:
    """Machine code of a StepCode. Calls release the interpreter lock; any number of threads may run it at once."""

    def __init__(self, what: StepCode, lanes: int | None = None) -> None:
        self.what = what
        self.lanes = host_lanes() if lanes is None else lanes
        self._code = MachineCode(emit_steps(what, self.lanes))
        numbers, pointers = [ctypes.c_int64] * 5, [ctypes.c_void_p] * 7
        self._steps = self._code.function(
            "steps", ctypes.CFUNCTYPE(ctypes.c_int64, *numbers, ctypes.c_double, *pointers)
        )
        self._lost = places(what.memory).get("lost")

    def memory(self, blocks: int) -> Array:
        """Scratch of each block, and what it keeps between calls: the torque in force, zero at first."""
        memory = aligned((blocks, sum(self.what.memory.values()), self.lanes))
        memory.fill(0.0)
        return memory

    def run(
        self,
        stretch: StepRange,
        state: Array,
        constants: Array,
        control: Array,
        noise: Array | None,
        ground: Array | None,
        record: Array,
        memory: Array,
        otherwise: Otherwise,
    ) -> None:
        """Advance blocks, one after the other.

        state (blocks, columns, lanes): at the beginning, and then at the end
        constants (blocks, columns, lanes); control, noise (blocks, ticks, columns, lanes)
        ground (steps, stages, columns): for all blocks
        record (blocks, records, columns, lanes): is filled; memory: of these blocks
        otherwise: takes a step of the lanes that are lost in it
        """
        addresses = [
            (None, 0) if array is None else (array.ctypes.data, 0 if array is ground else array.strides[0])
            for array in (state, constants, control, noise, ground, record, memory)
        ]
        for block in range(len(state)):
            pointers = [None if first is None else first + block * size for first, size in addresses]
            done = 0
            while done < stretch.count:
                done = self._steps(
                    stretch.count, stretch.start, done, stretch.every, stretch.hold, stretch.h, *pointers
                )
                if self._lost is None:
                    break
                for lane in np.flatnonzero(memory[block, self._lost]).tolist():
                    otherwise(block, lane, stretch.start + done - 1)


def in_blocks(columns: Mapping[str, Array], widths: Mapping[str, int], runs: int, lanes: int) -> Array:
    """Arrays (runs, …, width) by name as (blocks, …, columns, lanes); the last run fills the last block."""
    parts = [columns[name] for name in widths]
    middle = parts[0].shape[1:-1] if parts else ()
    together = np.concatenate(parts, axis=-1) if parts else np.zeros((runs, *middle, 0))
    blocks = -(-runs // lanes)
    rows = np.minimum(np.arange(blocks * lanes), runs - 1)
    lanes_last = np.moveaxis(together[rows].reshape(blocks, lanes, *together.shape[1:]), 1, -1)
    filled = aligned(lanes_last.shape)
    filled[...] = lanes_last
    return filled


def out_of_blocks(blocks: Array, widths: Mapping[str, int], runs: int) -> dict[str, Array]:
    """Blocks (blocks, …, columns, lanes) as arrays (runs, …, width) by name."""
    rows = np.moveaxis(blocks, -1, 1)
    rows = rows.reshape(-1, *rows.shape[2:])[:runs]
    ends = np.cumsum(list(widths.values()))[:-1]
    return dict(zip(widths, np.split(rows, ends, axis=-1), strict=True))
