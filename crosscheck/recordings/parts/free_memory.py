"""Memory that nobody uses any more, given back to the system between the parts of a long recording."""

from __future__ import annotations

import ctypes
import sys
from functools import cache
from typing import Any


def give_back_free_memory() -> None:
    """Give back what Arrow and the C library keep for later: they keep what the largest part has needed, in pieces.

    Where the C library has no malloc_trim, as outside Linux, Arrow alone does.
    """
    if "pyarrow" in sys.modules:
        sys.modules["pyarrow"].default_memory_pool().release_unused()
    trim = _trim()
    if trim is not None:
        trim(0)


@cache
def _trim() -> Any:
    try:
        return ctypes.CDLL(None).malloc_trim
    except (AttributeError, OSError, TypeError):  # another C library
        return None
