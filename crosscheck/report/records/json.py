"""Records as JSON files."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.report.plain_text import INVISIBLE_CHARACTERS


def as_bytes(data: Any) -> bytes:
    """Plain data as the text of a JSON file; characters that cannot be seen are escaped, as \\u202e."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    return INVISIBLE_CHARACTERS.sub(
        lambda found: found[0] if found[0] == "\n" else f"\\u{ord(found[0]):04x}", text
    ).encode()


def plain(value: Any) -> Any:
    """What JSON has: dictionaries for records, lists for arrays and tuples, None for NaN and ±∞."""
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, Path):
        return str(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value
