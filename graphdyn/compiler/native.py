"""The compiled back end: llvmlite turns a program into machine code for this processor."""

from __future__ import annotations

import ctypes
import os
import threading
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from graphdyn.compiler.disk_cache import cached_code
from graphdyn.compiler.interpreter import Run, merged
from graphdyn.compiler.llvm.emitter import emit, scratch
from graphdyn.compiler.llvm.memory import aligned, places
from graphdyn.compiler.llvm.precision import DOUBLE, Precision
from graphdyn.compiler.llvm.vector_code import GUARD_KINDS, GUARD_STARTS
from graphdyn.compiler.rolled.program import LongProgram
from graphdyn.compiler.rolled.rolled_code import emit_long, long_scratch
from graphdyn.layout import Array
from graphdyn.scalars.expressions import Guard, Program

MAX_CACHED_RESULT_BYTES = 1 << 20
"""Bytes of results beyond which they bypass the caches: half of a usual second-level cache."""

OPTIMIZATION = 2
"""LLVM's level."""

compiling = threading.RLock()
"""Held while programs are recorded, while llvmlite is used, and while the process forks: otherwise the child could
inherit a lock, this one or llvmlite's own, that a thread of the parent held and that is never released."""

if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=compiling.acquire, after_in_parent=compiling.release, after_in_child=compiling.release)


@dataclass(frozen=True, eq=False)
class RowCall:
    """A call on one row of memory: function(table), and the program that the function belongs to."""

    function: Any
    table: Any
    program: CompiledProgram

    def __call__(self) -> None:
        self.function(self.table)


class CompiledProgram:
    """Machine code of a program. Calls release the interpreter lock; any number of threads may run it at once.

    one_row: for one row after the other, with as few lanes as columns are read and written by
    """

    def __init__(self, program: Program | LongProgram, one_row: bool = False, precision: Precision = DOUBLE) -> None:
        self._program, self._dtype = program, precision.dtype
        self.lanes = 2 if one_row else host_lanes() * DOUBLE.bits // precision.bits
        if isinstance(program, Program):
            code = emit(program, self.lanes, precision, ahead=not one_row)
            self._scratch = scratch(program, self.lanes, precision)
        else:
            code = emit_long(program, self.lanes, precision)
            self._scratch = long_scratch(program, self.lanes, precision)
        self._code = MachineCode(code)
        self._table = ctypes.c_void_p * (2 + len(program.inputs) + len(program.outputs))
        prototype = ctypes.CFUNCTYPE(None, ctypes.c_int64, ctypes.c_int64, ctypes.c_bool, ctypes.c_void_p)
        self._batch = self._code.function("batch", prototype)
        # keeps the interpreter lock: releasing it would take longer than the computation
        self._single = self._code.function("single", ctypes.PYFUNCTYPE(None, ctypes.c_void_p))

    def bind(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> Run:
        """run(first, last) for C-contiguous arrays (N, width), as Interpreter.bind gives."""
        arrays = self._arrays(inputs, outputs)
        bypass = sum(outputs[name].nbytes for name in self._program.outputs) > MAX_CACHED_RESULT_BYTES

        def run(first: int, last: int) -> dict[Guard, float]:
            if last - first < self.lanes:
                return self._short(first, last, inputs, outputs)
            guarded = guard_memory(self.lanes, self._dtype)
            self._batch(first, last, bypass, self._table_of(arrays, guarded))
            return guards(self._program, guarded)

        return run

    def bind_row(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> RowCall:
        """A call without arguments on arrays of as many rows as lanes, no guards: for one state after the other.

        Not for several threads at once.
        """
        guarded = guard_memory(self.lanes, self._dtype)
        return RowCall(self._single, self._table_of(self._arrays(inputs, outputs), guarded), self)

    def _table_of(self, arrays: list[Array], guarded: Array) -> Any:
        """What the code reads, with scratch of its own. It keeps alive whatever it leads to."""
        found, owned = places([self._own_scratch(), *arrays, guarded])
        table = self._table(*found)
        table.owned = owned  # type: ignore[attr-defined]
        return table

    def _arrays(self, inputs: Mapping[str, Array], outputs: Mapping[str, Array]) -> list[Array]:
        return [inputs[name] for name in self._program.inputs] + [outputs[name] for name in self._program.outputs]

    def _own_scratch(self) -> Array:
        if not self._scratch.size:
            return self._scratch
        rows = aligned(self._scratch.shape, self._dtype)
        rows[:] = self._scratch
        return rows

    def _short(
        self, first: int, last: int, inputs: Mapping[str, Array], outputs: Mapping[str, Array]
    ) -> dict[Guard, float]:
        """Fewer rows than lanes: the missing ones repeat the last."""
        rows = np.minimum(np.arange(first, first + self.lanes), last - 1)
        copies = {name: inputs[name][rows] for name in self._program.inputs}
        widths = {name: len(numbers) for name, numbers in self._program.outputs.items()}
        results = {name: np.empty((self.lanes, width), self._dtype) for name, width in widths.items()}
        guarded = self.bind(copies, results)(0, self.lanes)
        for name, result in results.items():
            outputs[name][first:last] = result[: last - first]
        return guarded


def guard_memory(lanes: int, dtype: np.dtype[Any] = DOUBLE.dtype) -> Array:
    """Memory of the guards of compiled code, before it has seen anything."""
    return _guard_starts(lanes, dtype).copy()


@cache
def _guard_starts(lanes: int, dtype: np.dtype[Any]) -> Array:
    return np.repeat(np.array(GUARD_STARTS, dtype=dtype)[:, None], lanes, axis=1)


def guards(program: Program | LongProgram, guarded: Array) -> dict[Guard, float]:
    """What compiled code has seen, all lanes together."""
    rows = guarded.tolist()
    return {kind: merged(kind, rows[GUARD_KINDS.index(kind)]) for kind in program.guards}


class MachineCode:
    """The functions of a module of LLVM code, as long as this object lives."""

    def __init__(self, code: str) -> None:
        self._text = code
        with compiling:
            llvm = _binding()
            cpu, features = llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()
            target = llvm.Target.from_default_triple().create_target_machine(
                cpu=cpu, features=features, opt=OPTIMIZATION, jit=True
            )
            maker = f"LLVM {llvm.llvm_version_info} {OPTIMIZATION} {target.triple} {cpu} {features}"
            machine_code = cached_code(f"{maker}\n{code}".encode(), lambda: _compiled(code, target))
            self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), target)
            self._engine.add_object_file(llvm.ObjectFileRef.from_data(machine_code))
            self._engine.finalize_object()
        weakref.finalize(self, _dispose, self._engine).atexit = False

    def __reduce__(self) -> tuple[type[MachineCode], tuple[str]]:
        """Compiled again: half a copy of an engine would end with a traceback."""
        return MachineCode, (self._text,)

    def function(self, name: str, prototype: Any) -> Any:
        """One of them, as a ctypes function."""
        with compiling:
            return prototype(self._engine.get_function_address(name))


def _compiled(code: str, target: Any) -> bytes:
    """The object file of a module of LLVM code."""
    module = _binding().parse_assembly(code)
    module.triple, module.data_layout = target.triple, str(target.target_data)
    module.verify()
    compiled: bytes = target.emit_object(module)
    return compiled


def _dispose(engine: Any) -> None:
    with compiling:
        engine.close()


def host_lanes() -> int:
    """Doubles in the widest vector of this processor."""
    with compiling:
        features = _binding().get_host_cpu_features()
    return 8 if features.get("avx512f") else 4 if features.get("avx2") else 2


def try_out() -> None:
    """Compile and run something small. Raises whatever goes wrong where llvmlite is missing, too old or forbidden."""
    code = MachineCode("define void @nothing(ptr %unused) { ret void }")
    code.function("nothing", ctypes.CFUNCTYPE(None, ctypes.c_void_p))(None)
    host_lanes()


def _binding() -> Any:
    import llvmlite.binding as llvm  # imported where first used: import graphdyn stays light

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    return llvm
