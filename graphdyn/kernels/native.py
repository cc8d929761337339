"""The compiled back end: llvmlite turns a program into machine code for this processor."""

from __future__ import annotations

import ctypes
import threading
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np

from graphdyn.kernels.aligned import aligned
from graphdyn.kernels.emitter import WATCHES, emit, scratch
from graphdyn.kernels.expressions import Program, Watch
from graphdyn.kernels.interpreter import Run, merged
from graphdyn.layout import Array

CACHE = 1 << 20
"""Bytes of results beyond which they bypass the caches: half of a usual second-level cache."""

_compiling = threading.Lock()


class CompiledProgram:
    """Machine code of a program. Calls release the interpreter lock; any number of threads may be in it."""

    def __init__(self, program: Program, lanes: int | None = None) -> None:
        self._program = program
        self.lanes = host_lanes() if lanes is None else lanes
        with _compiling:
            self._engine, address = _machine_code(emit(program, self.lanes, "program"))
        n_arrays = len(program.inputs) + len(program.outputs)
        pointers = [ctypes.c_void_p] * (n_arrays + 2)
        self._call = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, ctypes.c_bool, *pointers)(address)
        self._scratch = scratch(program, self.lanes)

    def bind(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> Run:
        """run(first, last) for C-contiguous arrays (N, width), as Interpreter.bind gives."""
        arrays = [inputs[name] for name in self._program.inputs] + [outputs[name] for name in self._program.outputs]
        addresses = [array.ctypes.data for array in arrays]
        bypass = sum(outputs[name].nbytes for name in self._program.outputs) > CACHE

        def run(first: int, last: int) -> dict[Watch, float]:
            if last - first < self.lanes:
                return self._short(first, last, inputs, outputs)
            rows = self._rows()
            watched = np.empty((len(WATCHES), self.lanes))
            self._call(first, last, bypass, rows.ctypes.data, *addresses, watched.ctypes.data)
            return {kind: merged(kind, watched[WATCHES.index(kind)].tolist()) for kind in self._program.watches}

        return run

    def bind_row(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> Callable[[], None]:
        """A call without arguments on arrays of as many rows as lanes, nothing watched: for one state after the other.

        Not for several threads at once.
        """
        arrays = [inputs[name] for name in self._program.inputs] + [outputs[name] for name in self._program.outputs]
        owned = [self._rows(), *arrays, np.empty((len(WATCHES), self.lanes))]
        call = partial(
            self._call,
            ctypes.c_int64(0),
            ctypes.c_int64(self.lanes),
            ctypes.c_bool(False),
            *(ctypes.c_void_p(array.ctypes.data) for array in owned),
        )
        call.owned = owned  # type: ignore[attr-defined]  # the addresses stay valid as long as the call
        return call

    def _rows(self) -> Array:
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
        watches = self.bind(copies, results)(0, self.lanes)
        for name, result in results.items():
            outputs[name][first:last] = result[: last - first]
        return watches


def host_lanes() -> int:
    """Doubles in the widest vector of this processor."""
    features = _binding().get_host_cpu_features()
    return 8 if features.get("avx512f") else 4 if features.get("avx2") else 2


def _machine_code(code: str) -> tuple[Any, int]:
    """The engine that owns the code, and the address of its function."""
    llvm = _binding()
    target = llvm.Target.from_default_triple().create_target_machine(
        cpu=llvm.get_host_cpu_name(), features=llvm.get_host_cpu_features().flatten(), opt=2, jit=True
    )
    module = llvm.parse_assembly(code)
    module.triple, module.data_layout = target.triple, str(target.target_data)
    module.verify()
    engine = llvm.create_mcjit_compiler(module, target)
    engine.finalize_object()
    return engine, engine.get_function_address("program")


def _binding() -> Any:
    import llvmlite.binding as llvm  # imported where first used: import graphdyn stays light

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm
