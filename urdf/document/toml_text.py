"""TOML that can ask for no more than its bytes: bounded nesting, and numbers that a double can hold."""

from __future__ import annotations

import math
import re
import sys
import tomllib
from typing import Any

MAX_DEPTH = 50
"""Largest number of tables and lists within each other, and of parts of a key; the files of graphdyn have five."""

_PART_OF_A_KEY = re.compile(r"[\w\"'-]\s*\.")


def parsed_toml(content: bytes) -> dict[str, Any]:
    """The document, whose whole numbers have any size. Raises ValueError, saying what is wrong."""
    try:
        text = content.decode()
    except UnicodeDecodeError as error:
        raise ValueError(f"is no UTF-8 text (byte {error.start}); save it as UTF-8") from None
    for number, line in enumerate(text.splitlines(), 1):  # the time of tomllib grows with the square of the parts
        parts = max(len(_PART_OF_A_KEY.findall(piece)) for piece in re.split(r"[=,{}\[\]]", line))
        if parts > MAX_DEPTH:
            raise ValueError(f"line {number}: a key of more than {MAX_DEPTH} parts")
    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ValueError(f"is no TOML: {_TOO_DEEP}") from None
    except ValueError as error:  # also of numbers with thousands of digits
        raise ValueError(f"is no TOML: {error}") from None


def toml_document(content: bytes) -> dict[str, Any]:
    """The document. Raises ValueError, saying what is wrong, also for deep nesting and numbers beyond a double."""
    document = parsed_toml(content)
    waiting: list[tuple[str, Any, int]] = [("", document, 0)]
    while waiting:
        where, value, depth = waiting.pop()
        if depth > MAX_DEPTH:
            raise ValueError(_TOO_DEEP)
        if isinstance(value, dict):
            waiting += [(f"{where}.{key}" if where else key, one, depth + 1) for key, one in value.items()]
        elif isinstance(value, list):
            waiting += [(where, one, depth + 1) for one in value]
        elif isinstance(value, int) and abs(value) > sys.float_info.max:
            raise ValueError(
                f"{where} is a number of some {round(value.bit_length() * math.log10(2))} digits; give one below 1e308"
            )
    return document


_TOO_DEEP = f"more than {MAX_DEPTH} tables or lists within each other"
