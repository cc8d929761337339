"""Single-state calls as C functions of Python: arguments that are plain float64 vectors are copied without NumPy.

Compiled for a number of arguments and their length. Machine code reads the fields of NumPy's arrays, and works in the
memory of one thread. Whatever else is given, and other threads, go to a Python function, which takes what NumPy turns
into vectors, refuses the rest, and may make its own thread the one that is served.
"""

from __future__ import annotations

import ctypes
import sysconfig
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from graphdyn.compiler.llvm.memory import (
    DATA,
    DESCRIPTION,
    DIMENSIONS,
    OBJECT_HEAD_BYTES,
    SHAPE,
    STRIDES,
    TYPE,
    address,
    is_known,
)
from graphdyn.compiler.native import MachineCode, RowCall
from graphdyn.layout import Array

FASTCALL = 0x80
"""METH_FASTCALL: arguments as a C array and their number."""

FALLBACK_OFFSET, SERVED_OFFSET = OBJECT_HEAD_BYTES, OBJECT_HEAD_BYTES + 8
"""Offsets in a PythonCall: Python puts slots after the head of the object, in alphabetical order."""

THREAD, RUN, TABLE, RESULT, PLACES = range(5)
"""Numbers in a ThreadMemory: of its thread, then addresses of its row, of its result and of its arguments."""


class ThreadMemory(np.ndarray[Any, np.dtype[np.int64]]):
    """What machine code must know of the memory of one thread.

    owned: what the addresses belong to, which lives as long
    """

    owned: tuple[object, ...]


def of_this_thread(row: RowCall, arguments: Sequence[Array], result: Array) -> ThreadMemory:
    """The memory where the thread that asks has its arguments and its result."""
    addresses = [_address(row.function), ctypes.addressof(row.table), id(result), *map(address, arguments)]
    memory = np.array([_this_thread(), *addresses], dtype=np.int64).view(ThreadMemory)
    memory.owned = row, arguments, result
    return memory


NO_THREAD = np.array([-1], dtype=np.int64).view(ThreadMemory)
"""No thread has this number."""


class PythonCall:
    """What the C function of a call reads, and keeps alive.

    otherwise: called with whatever is no plain vector, and by threads that are not served
    served: the memory of the thread that is; replaced at once, so that never half of it is another thread's
    """

    __slots__ = ("otherwise", "served")

    def __init__(self, otherwise: Callable[..., object]) -> None:
        self.otherwise, self.served = otherwise, NO_THREAD

    def function(self, count: int, n: int) -> Callable[..., Array]:
        """function(*vectors) copies as many arguments (n,), runs the row and returns the result; function() runs it."""
        # self of the C function is this object, which the function then keeps alive
        new = ("PyCFunction_NewEx", ctypes.pythonapi)
        make = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p)(new)
        made: Callable[..., Array] = make(ctypes.addressof(_definition(count, n)), self, None)
        return made


def can_call() -> bool:
    """Whether objects have the layout that machine code reads, and a lock keeps other threads out while it does."""
    if sysconfig.get_config_var("Py_GIL_DISABLED") or not is_known():
        return False
    probe = PythonCall(can_call)
    # read as machine code will, and compared with what Python reads
    slots = [ctypes.c_void_p.from_address(id(probe) + offset).value for offset in (FALLBACK_OFFSET, SERVED_OFFSET)]
    return slots == [id(probe.otherwise), id(probe.served)]


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
    """Definition of calls with this number of arguments (n,)."""
    code = MachineCode(_code(count, n))
    definition = _MethodDefinition(
        b"single_state", _address(code.function("call", ctypes.CFUNCTYPE(None))), FASTCALL, None
    )
    definition.code = code
    ctypes.PYFUNCTYPE(None, ctypes.py_object)(("Py_IncRef", ctypes.pythonapi))(definition)  # functions need it for ever
    return definition


def _this_thread() -> int:
    """Its number, which no later thread gets."""
    state = ctypes.PYFUNCTYPE(ctypes.c_void_p)(("PyThreadState_Get", ctypes.pythonapi))
    number = ctypes.PYFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)(("PyThreadState_GetID", ctypes.pythonapi))
    return int(number(state()))


def _address(function: Any) -> int:
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def _code(count: int, n: int) -> str:
    """LLVM code of call(PythonCall, arguments, number of them): a reference to the result, as METH_FASTCALL asks."""
    lines: list[str] = []

    def read(name: str, kind: str, pointer: str, offset: int) -> str:
        lines.append(f"  {name}.at = getelementptr i8, ptr {pointer}, i64 {offset}")
        lines.append(f"  {name} = load {kind}, ptr {name}.at")
        return name

    def call(name: str, kind: str, function: Any, arguments: str) -> str:
        lines.append(f"  {name}.of = inttoptr i64 {_address(function)} to ptr")
        lines.append(f"  {name} = call {kind} {name}.of({arguments})")
        return name

    def copy(to: str, vector: str) -> None:
        lines.append(f"  call void @llvm.memcpy.p0.p0.i64(ptr {to}, ptr {vector}, i64 {8 * n}, i1 false)")

    def taken() -> list[str]:
        """The lines so far, which are not kept."""
        done = lines.copy()
        lines.clear()
        return done

    # the memory that is served, and whether it is that of the thread that calls
    python = ctypes.pythonapi
    read("%memory", "ptr", read("%object", "ptr", "%self", SERVED_OFFSET), DATA)
    state = call("%state", "ptr", python.PyThreadState_Get, "")
    thread = call("%thread", "i64", python.PyThreadState_GetID, f"ptr {state}")
    served = read("%served", "i64", "%memory", 8 * THREAD)
    lines += [f"  %same = icmp eq i64 {thread}, {served}", "  br i1 %same, label %own, label %other"]
    entry = taken()
    for k in range(count):
        x = f"%x{k}"
        # exactly an ndarray of one dimension and of float64, of length n, without gaps: else Python converts or refuses
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
        # all into a copy on the stack first, then to their places
        lines += [f"  %copy{k} = getelementptr double, ptr %copies, i64 {n * k}"]
        copy(f"%copy{k}", read(f"%data{k}", "ptr", f"%x{k}", DATA))
    for k in range(count):  # an argument may be in the place of another
        copy(read(f"%place{k}", "ptr", "%memory", 8 * (PLACES + k)), f"%copy{k}")
    given = taken()
    for field, name in ((RUN, "%run"), (TABLE, "%table"), (RESULT, "%result")):
        read(name, "ptr", "%memory", 8 * field)
    # the caller owns the reference that it gets
    lines += ["  call void %run(ptr %table)", f"  %keep = inttoptr i64 {_address(python.Py_IncRef)} to ptr"]
    lines += ["  call void %keep(ptr %result)", "  ret ptr %result"]
    running = taken()
    # the Python function, with the arguments as they came; its answer, or NULL with an exception, is passed on
    read("%otherwise", "ptr", "%self", FALLBACK_OFFSET)
    call("%answer", "ptr", python.PyObject_Vectorcall, "ptr %otherwise, ptr %arguments, i64 %count, ptr null")
    return "\n".join(
        [
            "declare void @llvm.memcpy.p0.p0.i64(ptr, ptr, i64, i1)",
            "define ptr @call(ptr %self, ptr %arguments, i64 %count) {",
            f"  %copies = alloca [{count * n} x double]",
            *entry,
            "own:",
            # no arguments: those in memory; as many as the verb has: copied there; else Python says what is wrong
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
