"""Where NumPy's arrays have their fields: an address read from there takes a fiftieth of array.ctypes.data.

PyArrayObject_fields of NumPy's C interface, the same in NumPy 1 and 2, after the head of every Python object. It is
tried out before it is used.
"""

from __future__ import annotations

import ctypes
import platform
from collections.abc import Sequence
from functools import cache

import numpy as np

from graphdyn.layout import Array

HEAD = object.__basicsize__
"""Bytes of every Python object before its own fields; the last eight are its type."""

TYPE, DATA, DIMENSIONS, SHAPE, STRIDES, DESCRIPTION = (HEAD + offset for offset in (-8, 0, 8, 16, 24, 40))
"""Offsets in an array."""


def address(array: Array) -> int:
    """Of its first element."""
    if is_known():
        return ctypes.c_void_p.from_address(id(array) + DATA).value or 0
    return int(array.ctypes.data)


def places(arrays: Sequence[Array]) -> tuple[list[int], object]:
    """Where in memory the addresses of these are, for code that reads them there, and what must live meanwhile."""
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
