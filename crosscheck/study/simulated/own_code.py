"""Code of one's own that a study runs, each FILE.py:NAME with the whole path.

Methods, motions, laws of noise, errors of the model.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from crosscheck.user_code import module_of_file


def own(name: str) -> Any:
    """What has this name. Raises whatever the file raises."""
    where, _, inside = name.rpartition(":")
    return getattr(_module(where), inside)


@cache
def _module(path: str) -> ModuleType:
    return module_of_file(Path(path))
