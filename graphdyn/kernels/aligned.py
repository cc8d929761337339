"""Memory that starts with a cache line, so that whole lines can be written past the caches."""

from math import prod

import numpy as np

from graphdyn.kernels.array_layout import address
from graphdyn.layout import Array

LINE = 64
"""Bytes in a cache line, and in the widest vector."""


def aligned(shape: tuple[int, ...]) -> Array:
    """An uninitialised array."""
    size = prod(shape)
    memory = np.empty(size + LINE // 8)
    start = -address(memory) % LINE // 8
    return memory[start : start + size].reshape(shape)
