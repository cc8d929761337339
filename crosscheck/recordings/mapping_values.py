"""Values of a mapping, as TOML has them, checked."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

import numpy as np

from crosscheck.recordings.errors import BadMapping
from graphdyn.layout import Array


def toml_square(table: Mapping[str, Any], key: str, n: int, where: str) -> Array:
    """n rows of n finite numbers (n, n). Raises BadMapping."""
    rows = table[key]
    if not isinstance(rows, list) or len(rows) != n:
        raise BadMapping(f"{where}: {key} needs {n} rows of {n} numbers")
    return np.array([toml_numbers({key: row}, key, n, 0.0, where) for row in rows])


def toml_numbers(table: Mapping[str, Any], key: str, n: int, default: float, where: str) -> Array:
    """n finite numbers; a single number is used n times. Raises BadMapping."""
    value = table.get(key, default)
    values = [value] * n if is_number(value) else value
    if not isinstance(values, list) or len(values) != n or not all(map(is_number, values)):
        raise BadMapping(f"{where}: {key} is {value!r}; give {n} numbers")
    return np.array(values, dtype=float)


def is_number(value: Any) -> bool:
    """Whether a double can hold it: integers of TOML have any number of digits."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and abs(value) <= sys.float_info.max


def toml_text(table: Mapping[str, Any], key: str, where: str) -> str | None:
    """A text, or None where the key is missing. Raises BadMapping."""
    value = table.get(key)
    if value is not None and not isinstance(value, str):
        raise BadMapping(f"{where}: {key} is {value!r}; give a text in quotes")
    return value


def toml_table(document: Mapping[str, Any], key: str, source: str) -> Mapping[str, Any]:
    """A table of the document. Raises BadMapping."""
    if not isinstance(document[key], dict):
        raise BadMapping(f"{source}: {key} is {document[key]!r}; make it a table: [{key}]")
    return dict(document[key])


def refuse_unknown(table: Mapping[str, Any], known: tuple[str, ...], where: str) -> None:
    """Raise BadMapping for a key that is not known."""
    unknown = [key for key in table if key not in known]
    if unknown:
        raise BadMapping(f"{where}: unknown key {unknown[0]!r}; known are {', '.join(known)}")


def toml_column(table: Mapping[str, Any], key: str, where: str) -> str | int:
    """The name of a column, or its number from 1. Raises BadMapping."""
    value = table.get(key)
    if not isinstance(value, str | int) or isinstance(value, bool):
        raise BadMapping(f"{where}: {key} is {value!r}; give its name, or its number from 1")
    return value
