"""Numbers as programs print them, in lines and in JSON, nan and inf among them, and decimals of any length.

Whole numbers that a double cannot hold, and numbers beyond the largest double, are none.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from crosscheck.quantities.tested_function import LongDecimal, significant_digits
from crosscheck.recordings.errors import quoted
from crosscheck.recordings.table import MAX_EXACT_INTEGER, is_exact
from graphdyn.layout import Array
from urdf.document import finite_number

DIGITS_OF_DOUBLES = 17
"""Significant digits that tell any double from all others."""

MAX_NESTING = 32
"""Largest number of dimensions of an answer."""

_NOT_FINITE = re.compile(r"[-+]?(?:nan|inf|infinity)", re.IGNORECASE | re.ASCII)
_DELIMITER = re.compile(r"[ \t]*[,;][ \t]*|[ \t]+")
_DECIMAL_COMMA = re.compile(r"\d,\d")


class UnreadableAnswer(Exception):
    """A text that is no answer. Its text says what was expected."""


class NoNumber(UnreadableAnswer):
    """A line with something that is no number."""


class BeyondDoubles(str):
    """A number of a JSON document that a double cannot hold, as written."""


def printed_number(text: str) -> float | None:
    """The number that a program prints, such as -1.5e-3, nan or -inf, a LongDecimal where it has more digits than a
    double; None for anything else."""
    return float(text) if _NOT_FINITE.fullmatch(text) else _with_all_digits(text)


def _with_all_digits(text: str) -> float | None:
    number = finite_number(text)
    return number if number is None or significant_digits(text) <= DIGITS_OF_DOUBLES else LongDecimal(text)


def printed_numbers(line: str) -> list[float]:
    """The numbers of a line, with commas, semicolons or blanks between them. Raises UnreadableAnswer."""
    line = line.strip(" \t\r\n")
    others = re.sub(r"[ \t]*,[ \t]*", ",", line)
    if (comma := _DECIMAL_COMMA.search(others)) and re.search(r"[; \t]", others):
        raise UnreadableAnswer(f"{quoted(comma[0])} is one number or two; write decimal points")
    cells = _DELIMITER.split(line)
    if not cells[-1]:  # a blank line, or a delimiter behind the last number
        cells.pop()
    numbers = []
    for cell in cells:
        number = printed_number(cell)
        if number is None:
            raise NoNumber(f"{quoted(cell)} is no number")
        numbers.append(number)
    return numbers


def read_json(content: bytes | str) -> Any:
    """The content of a JSON document, BeyondDoubles for numbers that a double cannot hold. Raises UnreadableAnswer."""
    try:
        return json.loads(content, parse_int=_integer, parse_float=_decimal, object_pairs_hook=_object)
    except RecursionError:
        raise UnreadableAnswer("is nested too deeply; give lists of numbers") from None
    except ValueError as error:
        raise UnreadableAnswer(f"is no JSON: {error}") from None


def _integer(text: str) -> int | BeyondDoubles:
    number = finite_number(text)  # int refuses thousands of digits
    return BeyondDoubles(text) if number is None or not is_exact(int(text)) else int(text)


def _decimal(text: str) -> float | BeyondDoubles:
    number = _with_all_digits(text)
    return BeyondDoubles(text) if number is None else number


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict[str, Any]()
    for key, value in pairs:
        if key in found:
            raise ValueError(f"an object has {quoted(key)} twice")
        found[key] = value
    return found


def flat_numbers(nested: Any) -> Array:
    """Numbers in nested lists, row by row (m,), decimals also as texts; null is no number.

    Raises UnreadableAnswer for anything else.
    """
    numbers = [_number_of(x) for x in _flat(nested, MAX_NESTING)]
    for number in numbers:
        if isinstance(number, BeyondDoubles) or (isinstance(number, int) and not is_exact(number)):
            raise UnreadableAnswer(f"no double holds {quoted(str(number))}")
        if number is not None and (isinstance(number, bool) or not isinstance(number, int | float)):
            raise UnreadableAnswer("the answer is no array of numbers")
    return as_array([np.nan if x is None else x for x in numbers])


def as_array(numbers: Sequence[float]) -> Array:
    """An array of doubles, or of objects where some are a LongDecimal."""
    long = any(isinstance(x, LongDecimal) for x in numbers)
    return np.array(numbers, dtype=object if long else float)


def _number_of(given: Any) -> Any:
    """A number for a decimal in quotation marks, for languages whose JSON has no long numbers."""
    if not isinstance(given, str) or isinstance(given, BeyondDoubles):
        return given
    number = printed_number(given)
    if number is None:
        raise UnreadableAnswer(f"{quoted(given)} is no decimal number, such as '-1.25e-3'")
    return number


def _flat(nested: Any, depth: int) -> Iterator[Any]:
    """The numbers of lists that are nested at most this deeply, row by row."""
    if depth < 0:
        raise UnreadableAnswer(f"the answer is nested more than {MAX_NESTING} times")
    if isinstance(nested, list):
        for inner in nested:
            yield from _flat(inner, depth - 1)
    else:
        yield nested


def whole_number(number: Any) -> int | None:
    """The integer, of a size that doubles hold exactly; None for anything else."""
    if isinstance(number, bool) or not isinstance(number, int | float) or not math.isfinite(number):
        return None
    return int(number) if abs(number) < MAX_EXACT_INTEGER and int(number) == number else None
