"""Memory that starts with a cache line, so that whole lines can be written past the caches; large pieces are reused.

New pages of memory are cleared by the system before they are used, which takes several times as long as the dynamics
of the samples that fit on them.
"""

import weakref
from math import prod

import numpy as np

from graphdyn.kernels.array_layout import address
from graphdyn.layout import Array

LINE = 64
"""Bytes in a cache line, and in the widest vector."""

LARGE = 1 << 20
"""Bytes from which memory is reused; the allocator keeps smaller pieces by itself."""

MOST_KEPT = 1 << 27
"""Bytes that are kept at most: the whole answer of 150,000 samples of a six-axis arm."""

_kept: dict[int, Array] = {}
"""Memory that no array uses any more, by number, the oldest first. Its methods are atomic: threads share it."""


def aligned(shape: tuple[int, ...]) -> Array:
    """An uninitialised array."""
    size = prod(shape)
    memory = _memory(size + LINE // 8)
    start = -address(memory) % LINE // 8
    return memory[start : start + size].reshape(shape)


def _memory(size: int) -> Array:
    """So many numbers; those that become large memory again when no array refers to them."""
    if 8 * size < LARGE:
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
        if sum(one.nbytes for one in list(_kept.values())) <= MOST_KEPT:
            break
        _kept.pop(number, None)
        del oldest
