"""Arrays in the text of a page: one compressed buffer, and where each array lies in it."""

from __future__ import annotations

import gzip
from base64 import b64encode
from typing import Any, Literal

import numpy as np

Kind = Literal["f4", "f8", "u2", "u4"]

ALIGNMENT = 8
"""Bytes: typed arrays of JavaScript begin at multiples of the size of their numbers."""


class NumberStore:
    """Collects arrays, little-endian. The same arrays in the same order give the same text."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._length = 0

    def add(self, array: Any, kind: Kind) -> list[Any]:
        """Kind, first byte and number of entries, from which player/numbers.js makes a typed array."""
        data = np.ascontiguousarray(array, dtype=f"<{kind}").tobytes()
        place = [kind, self._length, np.size(array)]
        padded = data + bytes(-len(data) % ALIGNMENT)
        self._parts.append(padded)
        self._length += len(padded)
        return place

    def text(self) -> str:
        """All arrays, compressed."""
        return compressed(b"".join(self._parts))


def compressed(content: bytes) -> str:
    """gzip in base64. The same content gives the same text."""
    return b64encode(gzip.compress(content, 9, mtime=0)).decode()
