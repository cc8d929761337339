"""The compiled back end: llvmlite turns a program into machine code for this processor."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from graphdyn.kernels.aligned import aligned
from graphdyn.kernels.emitter import emit, scratch
from graphdyn.kernels.expressions import Program, Watch
from graphdyn.kernels.interpreter import Run, merged
from graphdyn.kernels.vector_code import WATCH_STARTS, WATCHES
from graphdyn.layout import Array

CACHE = 1 << 20
"""Bytes of results beyond which they bypass the caches: half of a usual second-level cache."""

_compiling = threading.Lock()


class CompiledProgram:
    """Machine code of a program. Calls release the interpreter lock; any number of threads may be in it."""

    def __init__(self, program: Program, lanes: int | None = None) -> None:
        self._program = program
        self.lanes = host_lanes() if lanes is None else lanes
        self._engine = machine_code(emit(program, self.lanes))
        self._scratch = scratch(program, self.lanes)
        pointers = [ctypes.c_void_p] * (2 + len(program.inputs) + len(program.outputs))
        prototype = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, ctypes.c_bool, *pointers)
        self._rows = prototype(self._engine.get_function_address("rows"))

    def bind(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> Run:
        """run(first, last) for C-contiguous arrays (N, width), as Interpreter.bind gives."""
        addresses = [array.ctypes.data for array in self._arrays(inputs, outputs)]
        bypass = sum(outputs[name].nbytes for name in self._program.outputs) > CACHE

        def run(first: int, last: int) -> dict[Watch, float]:
            if last - first < self.lanes:
                return self._short(first, last, inputs, outputs)
            rows, watched = self._own_scratch(), watch_memory(self.lanes)
            self._rows(first, last, bypass, rows.ctypes.data, *addresses, watched.ctypes.data)
            return watches(self._program, watched)

        return run

    def bind_row(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> Callable[[], object]:
        """A call without arguments on arrays of as many rows as lanes, nothing watched: for one state after the other.

        Not for several threads at once.
        """
        owned = [self._own_scratch(), *self._arrays(inputs, outputs), watch_memory(self.lanes)]
        table = (ctypes.c_void_p * len(owned))(*(array.ctypes.data for array in owned))
        # keeps the interpreter lock, whose release would take longer than the work
        single = ctypes.PYFUNCTYPE(None, ctypes.c_void_p)(self._engine.get_function_address("single"))
        call = partial(single, ctypes.c_void_p(ctypes.addressof(table)))
        call.owned = (self, table, owned)  # type: ignore[attr-defined]  # what the addresses point to lives as long
        return call

    def _arrays(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> list[Array]:
        return [inputs[name] for name in self._program.inputs] + [outputs[name] for name in self._program.outputs]

    def _own_scratch(self) -> Array:
        rows = aligned(self._scratch.shape)
        rows[:] = self._scratch
        return rows

    def _short(
        self, first: int, last: int, inputs: Mapping[str, Array], outputs: Mapping[str, Array]
    ) -> dict[Watch, float]:
        """Fewer rows than lanes: the last one stands in for those that are missing."""
        rows = np.minimum(np.arange(first, first + self.lanes), last - 1)
        copies = {name: inputs[name][rows] for name in self._program.inputs}
        results = {name: np.empty((self.lanes, len(numbers))) for name, numbers in self._program.outputs.items()}
        watched = self.bind(copies, results)(0, self.lanes)
        for name, result in results.items():
            outputs[name][first:last] = result[: last - first]
        return watched


def watch_memory(lanes: int) -> Array:
    """Where compiled code watches, before it has seen anything."""
    return np.repeat(np.array(WATCH_STARTS)[:, None], lanes, axis=1)


def watches(program: Program, watched: Array) -> dict[Watch, float]:
    """What compiled code has seen, all lanes together."""
    return {kind: merged(kind, watched[WATCHES.index(kind)].tolist()) for kind in program.watches}


def host_lanes() -> int:
    """Doubles in the widest vector of this processor."""
    features = _binding().get_host_cpu_features()
    return 8 if features.get("avx512f") else 4 if features.get("avx2") else 2


def machine_code(code: str) -> Any:
    """The engine that owns the machine code of a module; its get_function_address finds the functions."""
    with _compiling:
        llvm = _binding()
        target = llvm.Target.from_default_triple().create_target_machine(
            cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=2, jit=True
        )
        module = llvm.parse_assembly(code)
        module.triple, module.data_layout = target.triple, str(target.target_data)
        module.verify()
        engine = llvm.create_mcjit_compiler(module, target)
        engine.finalize_object()
        return engine


def _binding() -> Any:
    import llvmlite.binding as llvm  # imported where first used: import graphdyn stays light

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm
