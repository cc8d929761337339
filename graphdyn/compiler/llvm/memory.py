"""Offsets of the fields of NumPy's arrays: an address read from there takes a fiftieth of array.ctypes.data.

PyArrayObject_fields of NumPy's C interface, the same in NumPy 1 and 2, after the head of every Python object. It is
tried out before it is used.

Memory that starts with a cache line, so that whole lines can be written past the caches; large pieces are reused.

New pages of memory are cleared by the system before they are used, which takes several times as long as the dynamics
of the samples that fit on them.
"""

from __future__ import annotations

import ctypes
import platform
import weakref
from collections.abc import Sequence
from functools import cache
from math import prod
from typing import Any

import numpy as np

from graphdyn.compiler.llvm.precision import DOUBLE
from graphdyn.layout import Array

OBJECT_HEAD_BYTES = object.__basicsize__
"""Bytes of every Python object before its own fields; the last eight are its type."""

TYPE, DATA, DIMENSIONS, SHAPE, STRIDES, DESCRIPTION = (OBJECT_HEAD_BYTES + offset for offset in (-8, 0, 8, 16, 24, 40))
"""Offsets in an array."""


def address(array: Array) -> int:
    """Address of its first element."""
    if is_known():
        return ctypes.c_void_p.from_address(id(array) + DATA).value or 0
    return int(array.ctypes.data)


def places(arrays: Sequence[Array]) -> tuple[list[int], object]:
    """Address of the table of their addresses, for code that reads them there, and what must live meanwhile."""
    if is_known():
        return [id(array) + DATA for array in arrays], arrays
    addresses = np.array([array.ctypes.data for array in arrays], dtype=np.uintp)
    first = addresses.ctypes.data
    return [first + 8 * k for k in range(len(arrays))], (arrays, addresses)


@cache
def is_known() -> bool:
    """Whether arrays have their fields where they are looked for."""
    if platform.python_implementation() != "CPython" or ctypes.sizeof(ctypes.c_void_p) != 8:
        return False
    probe = np.zeros((7, 5, 3))[:, :4, :2]
    pointers = {
        offset: ctypes.c_void_p.from_address(id(probe) + offset).value
        for offset in (TYPE, DATA, SHAPE, STRIDES, DESCRIPTION)
    }
    sizes = ctypes.c_ssize_t * probe.ndim
    if ctypes.c_int.from_address(id(probe) + DIMENSIONS).value != probe.ndim:
        return False
    if (pointers[TYPE], pointers[DATA], pointers[DESCRIPTION]) != (
        id(np.ndarray),
        probe.ctypes.data,
        id(np.dtype(float)),
    ):
        return False
    found = [tuple(sizes.from_address(pointers[offset] or 0)) for offset in (SHAPE, STRIDES)]
    return found == [probe.shape, probe.strides]


CACHE_LINE_BYTES = 64
"""Bytes in a cache line, and in the widest vector."""

MIN_REUSED_BYTES = 1 << 20
"""Bytes from which memory is reused; the allocator keeps smaller pieces by itself."""

MAX_KEPT_BYTES = 1 << 27
"""Bytes that are kept at most: the whole answer of 150,000 samples of a six-axis arm."""

_kept: dict[int, Array] = {}
"""Memory that no array uses any more, by number, the oldest first. Its methods are atomic: threads share it."""


def aligned(shape: tuple[int, ...], dtype: np.dtype[Any] = DOUBLE.dtype) -> Array:
    """An uninitialized array of floating-point numbers."""
    size = prod(shape)
    needed = -(-size * dtype.itemsize // 8)  # as many doubles
    memory = _memory(needed + CACHE_LINE_BYTES // 8)
    start = -address(memory) % CACHE_LINE_BYTES // 8
    return memory[start : start + needed].view(dtype)[:size].reshape(shape)


def _memory(size: int) -> Array:
    """So many numbers; those that become large memory again when no array refers to them."""
    if 8 * size < MIN_REUSED_BYTES:
        return np.empty(size)
    memory = _taken(size)
    if memory is None:
        memory = np.empty(size)
    owner: Array = np.frombuffer(memory.data)  # views refer to it, not to the memory behind it
    weakref.finalize(owner, _keep, memory).atexit = False
    return owner


def _taken(size: int) -> Array | None:
    for number, memory in list(_kept.items()):
        if memory.size == size and _kept.pop(number, None) is not None:
            return memory
    return None


def _keep(memory: Array) -> None:
    _kept[id(memory)] = memory
    for number, oldest in list(_kept.items()):
        if sum(one.nbytes for one in list(_kept.values())) <= MAX_KEPT_BYTES:
            break
        _kept.pop(number, None)
        del oldest
