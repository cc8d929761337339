"""What a model holds, as a digest: equal models have equal ones, whatever they were read from."""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

import numpy as np


def content_digest(value: object) -> bytes:
    """SHA-256 of a dataclass of arrays, numbers, texts, tuples and other dataclasses: of its fields to the last bit."""
    return hashlib.sha256(b"\0".join(_parts(value))).digest()


def _parts(value: Any) -> list[bytes]:
    """Everything in it, each part after its kind and size, so that no two values have the same parts."""
    parts: list[bytes] = []
    pending = [value]
    while pending:
        part = pending.pop()
        kind: Any = type(part)
        if kind is np.ndarray:
            parts += (f"{part.dtype}{part.shape}".encode(), part.tobytes())
        elif kind is tuple:
            parts.append(b"tuple %d" % len(part))
            pending += part
        elif names := _names(kind):
            parts.append(kind.__qualname__.encode())
            pending += [getattr(part, name) for name in names]
        else:
            parts.append(repr(part).encode())
    return parts


@cache
def _names(kind: Any) -> tuple[str, ...]:
    return tuple(each.name for each in fields(kind)) if is_dataclass(kind) else ()
