"""The NumPy back end: a program, operation by operation, on the samples of a batch.

No code is generated. Samples go through in blocks small enough that all intermediate results stay in the cache.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from itertools import accumulate
from typing import Any

import numpy as np

from graphdyn.layout import Array
from graphdyn.scalars.expressions import Guard, Program, operands

BLOCK_SAMPLES = 2048
"""Samples at a time, at most: a few hundred live values of 16 kB each fit into the second-level cache."""

MAX_LIVE_NUMBERS = 1 << 20
"""Numbers alive at a time, which bounds the block of a program with many outputs: 8 MB."""

_UFUNCS: dict[str, Callable[..., Any]] = {
    "+": np.add,
    "-": np.subtract,
    "*": np.multiply,
    "/": np.divide,
    "negate": np.negative,
    "sine": np.sin,
    "cosine": np.cos,
}


Run = Callable[[int, int], dict[Guard, float]]
"""run(first, last) fills rows first … last - 1 of the outputs and returns what the guards found."""


class Interpreter:
    """A program on NumPy arrays."""

    lanes = 1

    def __init__(self, program: Program) -> None:
        self._program = program
        self._last_uses = _last_uses(program)
        # how many values are held after each operation: the most of them bound the size of a block
        alive = accumulate(1 - len(finished) for finished in self._last_uses)
        self._block_size = min(BLOCK_SAMPLES, MAX_LIVE_NUMBERS // max(alive, default=1) + 1)

    def bind(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> Run:
        """The program on arrays (N, width). Non-finite input gives NaN in its own row only."""

        def run(first: int, last: int) -> dict[Guard, float]:
            size = self._block_size
            seen = [self._block(start, min(start + size, last), inputs, outputs) for start in range(first, last, size)]
            return together(self._program.guards, seen)

        return run

    def bind_row(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> Callable[[], object]:
        """A call without arguments on arrays of `lanes` rows."""
        return partial(self.bind(inputs, outputs), 0, self.lanes)

    def _block(
        self, first: int, last: int, inputs: Mapping[str, Array], outputs: Mapping[str, Array]
    ) -> dict[Guard, float]:
        values: list[Any] = [None] * len(self._program.operations)
        # columns one after the other in memory, as every operation reads whole columns
        rows = {name: np.ascontiguousarray(inputs[name][first:last].T) for name in self._program.inputs}
        with np.errstate(all="ignore"):
            for number, (kind, *arguments) in enumerate(self._program.operations):
                if kind == "constant":
                    values[number] = arguments[0]
                elif kind == "input":
                    values[number] = rows[arguments[0]][arguments[1]]
                else:
                    values[number] = _UFUNCS[kind](*(values[k] for k in arguments))
                for k in self._last_uses[number]:
                    values[k] = None
        for name, numbers in self._program.outputs.items():
            for column, number in enumerate(numbers):
                outputs[name][first:last, column] = values[number]
        return {
            kind: merged(kind, [_guarded(kind, values[k]) for k in numbers])
            for kind, numbers in self._program.guards.items()
        }


def merged(kind: Guard, values: list[float]) -> float:
    """What several guards have found together."""
    return min(values, default=np.inf) if kind == "minimum" else sum(values, 0.0)


def together(kinds: Iterable[Guard], seen: Sequence[Mapping[Guard, float]]) -> dict[Guard, float]:
    """What the guards of several runs have found together."""
    return {kind: merged(kind, [guards[kind] for guards in seen]) for kind in kinds}


def _guarded(kind: Guard, values: Array) -> float:
    with np.errstate(invalid="ignore", over="ignore"):
        if kind == "minimum":
            return float(np.fmin.reduce(np.atleast_1d(values), initial=np.inf))
        return float(np.sum(values * 0.0 if kind == "finite" else values * values))


def _last_uses(program: Program) -> list[list[int]]:
    """Per operation, the values that are not needed after it."""
    kept = {k for numbers in (*program.outputs.values(), *program.guards.values()) for k in numbers}
    last: dict[int, int] = {}
    for number, operation in enumerate(program.operations):
        for k in operands(operation):
            last[k] = number
    uses: list[list[int]] = [[] for _ in program.operations]
    for k, number in last.items():
        if k not in kept:
            uses[number].append(k)
    return uses
