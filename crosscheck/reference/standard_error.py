"""Output of C++ libraries on standard error, which bypasses Python."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def kept_standard_error() -> Iterator[list[str]]:
    """Collect standard error instead of showing it; at the end the list holds its lines. Affects the whole process."""
    written: list[str] = []
    kept = os.dup(2)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 2)
        try:
            yield written
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            file.seek(0)
            written += file.read().decode(errors="replace").splitlines()
