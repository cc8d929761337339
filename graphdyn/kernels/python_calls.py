"""Single-state calls as C functions of Python: arguments that are plain float64 vectors are copied without NumPy.

Compiled for a number of arguments and their length. Machine code reads the fields of NumPy's arrays, and works in the
memory of one thread. Whatever else is given, and other threads, go to a Python function, which takes anything that
NumPy does, refuses the rest, and may make its own thread the one that is served.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from graphdyn.kernels.array_layout import DATA, DESCRIPTION, DIMENSIONS, SHAPE, STRIDES, TYPE, address, is_known
from graphdyn.kernels.native import MachineCode, RowCall, compiling
from graphdyn.layout import Array

FASTCALL = 0x80
"""METH_FASTCALL: arguments as a C array and their number."""

OTHERWISE, THREAD, RUN, TABLE, RESULT, PLACES = range(6)
"""What machine code reads: the Python function; the thread that is served, its row, result and places of arguments."""

NOBODY = -1
"""No thread has this number."""


class Fields(np.ndarray[Any, np.dtype[np.intp]]):
    """Addresses for machine code.

    otherwise: lives as long
    """

    otherwise: Callable[..., Array]


class PythonCall:
    """function(*vectors) fills the arguments (n,), runs the row and returns the result; function() runs it as it is.

    otherwise: called with whatever is no plain vector of that length, and by threads that are not served. It must keep
    what it serves alive.
    """

    def __init__(self, count: int, n: int, otherwise: Callable[..., Array]) -> None:
        self._fields = np.zeros(PLACES + count, dtype=np.intp).view(Fields)
        self._fields[[OTHERWISE, THREAD]] = id(otherwise), NOBODY
        self._fields.otherwise = otherwise
        with compiling:  # one definition for all threads: functions that share it outlive whatever else refers to it
            definition = _definition(count, n)
        make = ctypes.pythonapi.PyCFunction_NewEx
        make.restype, make.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p]
        self.function: Callable[..., Array] = make(ctypes.addressof(definition), self._fields, None)

    def serve(self, memory: NDArray[np.intp]) -> None:
        """From now on the thread whose memory this is, and no other; what of_this_thread gave there."""
        self._fields[THREAD:] = memory


def of_this_thread(row: RowCall, arguments: Sequence[Array], result: Array) -> NDArray[np.intp]:
    """The fields from THREAD on. All that is given must live as long as they are served."""
    return np.array([_this_thread(), row.function, row.table, id(result), *map(address, arguments)], dtype=np.intp)


def can_call() -> bool:
    """Whether arrays have the layout that machine code reads."""
    return is_known()


class _MethodDefinition(ctypes.Structure):
    """PyMethodDef."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("method", ctypes.c_void_p),
        ("flags", ctypes.c_int),
        ("documentation", ctypes.c_char_p),
    )


@cache
def _definition(count: int, n: int) -> _MethodDefinition:
    """Of calls with this number of arguments (n,)."""
    code = MachineCode(_code(count, n))
    address = ctypes.cast(code.function("call", ctypes.CFUNCTYPE(None)), ctypes.c_void_p).value
    definition = _MethodDefinition(b"single_state", address, FASTCALL, None)
    definition.code = code  # lives as long
    return definition


def _this_thread() -> int:
    """Its number, which no later thread gets."""
    state, number = ctypes.pythonapi.PyThreadState_Get, ctypes.pythonapi.PyThreadState_GetID
    state.restype, number.restype, number.argtypes = ctypes.c_void_p, ctypes.c_int64, [ctypes.c_void_p]
    return int(number(state()))


def _address(function: Any) -> int:
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def _code(count: int, n: int) -> str:
    """LLVM code of call(fields, arguments, number of them): a reference to the result, as METH_FASTCALL asks."""
    lines: list[str] = []

    def read(name: str, kind: str, pointer: str, offset: int) -> str:
        lines.append(f"  {name}.at = getelementptr i8, ptr {pointer}, i64 {offset}")
        lines.append(f"  {name} = load {kind}, ptr {name}.at")
        return name

    def call(name: str, kind: str, function: Any, arguments: str) -> str:
        lines.append(f"  {name}.of = inttoptr i64 {_address(function)} to ptr")
        lines.append(f"  {name} = call {kind} {name}.of({arguments})")
        return name

    def taken() -> list[str]:
        """The lines so far, which are not kept."""
        done = lines.copy()
        lines.clear()
        return done

    python = ctypes.pythonapi
    read("%fields", "ptr", "%self", DATA)
    state = call("%state", "ptr", python.PyThreadState_Get, "")
    thread = call("%thread", "i64", python.PyThreadState_GetID, f"ptr {state}")
    served = read("%served", "i64", "%fields", 8 * THREAD)
    lines += [f"  %same = icmp eq i64 {thread}, {served}", "  br i1 %same, label %own, label %other"]
    entry = taken()
    for k in range(count):
        x = f"%x{k}"
        read(x, "ptr", "%arguments", 8 * k)
        read(f"{x}.type", "i64", x, TYPE)
        read(f"{x}.dimensions", "i32", x, DIMENSIONS)
        read(f"{x}.description", "i64", x, DESCRIPTION)
        tests = [
            f"icmp eq i64 {x}.type, {id(np.ndarray)}",
            f"icmp eq i32 {x}.dimensions, 1",
            f"icmp eq i64 {x}.description, {id(np.dtype(float))}",
        ]
        lines += [f"  {x}.test{i} = {test}" for i, test in enumerate(tests)]
        lines += [f"  {x}.some = and i1 {x}.test0, {x}.test1", f"  {x}.plain = and i1 {x}.some, {x}.test2"]
        lines += [f"  br i1 {x}.plain, label %sizes{k}, label %other", f"sizes{k}:"]
        read(f"{x}.size", "i64", read(f"{x}.shape", "ptr", x, SHAPE), 0)
        read(f"{x}.stride", "i64", read(f"{x}.strides", "ptr", x, STRIDES), 0)
        lines += [f"  {x}.long = icmp eq i64 {x}.size, {n}", f"  {x}.dense = icmp eq i64 {x}.stride, 8"]
        lines += [f"  {x}.fits = and i1 {x}.long, {x}.dense", f"  br i1 {x}.fits, label %next{k}, label %other"]
        lines += [f"next{k}:"]
    for k in range(count):
        data, place = read(f"%data{k}", "ptr", f"%x{k}", DATA), read(f"%place{k}", "ptr", "%fields", 8 * (PLACES + k))
        lines += [f"  call void @llvm.memmove.p0.p0.i64(ptr {place}, ptr {data}, i64 {8 * n}, i1 false)"]
    given = taken()
    for field, name in ((RUN, "%run"), (TABLE, "%table"), (RESULT, "%result")):
        read(name, "ptr", "%fields", 8 * field)
    lines += ["  call void %run(ptr %table)", f"  %keep = inttoptr i64 {_address(python.Py_IncRef)} to ptr"]
    lines += ["  call void %keep(ptr %result)", "  ret ptr %result"]
    running = taken()
    read("%otherwise", "ptr", "%fields", 8 * OTHERWISE)
    call("%answer", "ptr", python.PyObject_Vectorcall, "ptr %otherwise, ptr %arguments, i64 %count, ptr null")
    return "\n".join(
        [
            "declare void @llvm.memmove.p0.p0.i64(ptr, ptr, i64, i1)",
            "define ptr @call(ptr %self, ptr %arguments, i64 %count) {",
            *entry,
            "own:",
            f"  switch i64 %count, label %other [ i64 0, label %ready i64 {count}, label %given ]",
            "given:",
            *given,
            "  br label %ready",
            "ready:",
            *running,
            "other:",
            *taken(),
            "  ret ptr %answer",
            "}",
        ]
    )
