"""Single-state calls as C functions of Python: arguments that are plain float64 vectors are copied without NumPy.

Compiled for a number of arguments and their length. Machine code reads the fields of NumPy's arrays. Whatever else is
given goes to a Python function, which takes anything that NumPy does and refuses the rest.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np

from graphdyn.kernels.array_layout import DATA, DESCRIPTION, DIMENSIONS, SHAPE, STRIDES, TYPE, address, is_known
from graphdyn.kernels.native import MachineCode, RowCall
from graphdyn.layout import Array

FASTCALL = 0x80
"""METH_FASTCALL: arguments as a C array and their number."""


def python_call(
    row: RowCall, arguments: Sequence[Array], result: Array, otherwise: Callable[..., Array]
) -> Callable[..., Array] | None:
    """call(*vectors) fills the arguments (n,), runs the row and returns the result; call() runs it as it is.

    otherwise: called with whatever is no plain vector of that length
    None where arrays have another layout. All that is given must live as long as the call.
    """
    if not is_known():
        return None
    table = np.array([row.function, row.table, id(result), id(otherwise), *map(address, arguments)], dtype=np.intp)
    definition = _definition(len(arguments), len(arguments[0]))
    make = ctypes.pythonapi.PyCFunction_NewEx
    make.restype, make.argtypes = ctypes.py_object, [ctypes.c_void_p, ctypes.py_object, ctypes.c_void_p]
    call: Callable[..., Array] = make(ctypes.addressof(definition), table, None)
    return call


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


def _address(function: Any) -> int:
    return ctypes.cast(function, ctypes.c_void_p).value or 0


def _code(count: int, n: int) -> str:
    """LLVM code of call(table, arguments, number of them): a reference to the result, as METH_FASTCALL asks."""
    lines = []

    def read(name: str, kind: str, pointer: str, offset: int) -> str:
        lines.append(f"  {name}.at = getelementptr i8, ptr {pointer}, i64 {offset}")
        lines.append(f"  {name} = load {kind}, ptr {name}.at")
        return name

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
        data, place = read(f"%data{k}", "ptr", f"%x{k}", DATA), read(f"%place{k}", "ptr", "%fields", 8 * (4 + k))
        lines += [f"  call void @llvm.memmove.p0.p0.i64(ptr {place}, ptr {data}, i64 {8 * n}, i1 false)"]
    given, lines = lines, []
    for offset, name in ((0, "%run"), (8, "%table"), (16, "%result")):
        read(name, "ptr", "%fields", offset)
    running = lines
    return "\n".join(
        [
            "declare void @llvm.memmove.p0.p0.i64(ptr, ptr, i64, i1)",
            "define ptr @call(ptr %self, ptr %arguments, i64 %count) {",
            f"  %fields.at = getelementptr i8, ptr %self, i64 {DATA}",
            "  %fields = load ptr, ptr %fields.at",
            f"  switch i64 %count, label %other [ i64 0, label %ready i64 {count}, label %given ]",
            "given:",
            *given,
            "  br label %ready",
            "ready:",
            *running,
            "  call void %run(ptr %table)",
            f"  %keep = inttoptr i64 {_address(ctypes.pythonapi.Py_IncRef)} to ptr",
            "  call void %keep(ptr %result)",
            "  ret ptr %result",
            "other:",
            "  %otherwise.at = getelementptr i8, ptr %fields, i64 24",
            "  %otherwise = load ptr, ptr %otherwise.at",
            f"  %python = inttoptr i64 {_address(ctypes.pythonapi.PyObject_Vectorcall)} to ptr",
            "  %answer = call ptr %python(ptr %otherwise, ptr %arguments, i64 %count, ptr null)",
            "  ret ptr %answer",
            "}",
        ]
    )
