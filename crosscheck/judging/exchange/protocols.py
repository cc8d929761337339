"""How a question and its answer are written in one line: plain numbers, or JSON."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from crosscheck.judging.exchange.line_process import shown
from crosscheck.judging.exchange.printed_numbers import (
    NoNumber,
    UnreadableAnswer,
    as_array,
    flat_numbers,
    printed_numbers,
    read_json,
    whole_number,
)
from crosscheck.quantities.tested_function import Refusal
from graphdyn.errors import counted
from graphdyn.layout import Array

Shape = tuple[int | None, ...]
"""Shape of an answer; None for any number."""


@dataclass(frozen=True)
class Protocol:
    """question: its number, the function, its arguments by name, the shape of the answer → a line
    answer: a line, the number of the question, the shape → the answer

    Raises Unreadable of a line that is no answer to the question.
    """

    question: Callable[[int, str, Mapping[str, Array], Shape], str]
    answer: Callable[[str, int, Shape], Array | Refusal]


def _plain_question(_number: int, _function: str, arguments: Mapping[str, Array], _shape: Shape) -> str:
    return " ".join(number_text(x) for values in arguments.values() for x in values.flat)


def _plain_answer(line: str, _number: int, shape: Shape) -> Array | Refusal:
    if line.startswith("error"):
        return Refusal(line.removeprefix("error").lstrip(": ") or "error")
    try:
        numbers = as_array(printed_numbers(line))
    except NoNumber:
        raise UnreadableAnswer(f"{shown(line)}, which is no line of numbers") from None
    except UnreadableAnswer as error:
        raise UnreadableAnswer(f"{shown(line)}: {error}") from None
    return shaped(numbers, shape, shown(line))


def _json_question(number: int, function: str, arguments: Mapping[str, Array], shape: Shape) -> str:
    given = {name: x.tolist() for name, x in arguments.items()}
    return json.dumps({"id": number, "function": function, "shape": shape, "arguments": given})


def _json_answer(line: str, number: int, shape: Shape) -> Array | Refusal:
    form = '{"id": …, "answer": […]}'
    try:
        found = read_json(line)
    except UnreadableAnswer as error:
        raise UnreadableAnswer(f"{shown(line)}, which {re.split('[:;]', str(error))[0]}; an answer is {form}") from None
    if not isinstance(found, dict) or not ("answer" in found or "error" in found):
        raise UnreadableAnswer(f"{shown(line)}; an answer is {form}")
    if whole_number(found.get("id")) != number:
        raise UnreadableAnswer(f"{shown(line)}, whose id is not {number}; answer the questions in their order")
    if "error" in found:
        return Refusal(str(found["error"]))
    try:
        numbers = flat_numbers(found["answer"])
    except UnreadableAnswer as error:
        raise UnreadableAnswer(f"{shown(line)}: {error}") from None
    return shaped(numbers, shape, shown(line))


def shaped(numbers: Array, shape: Shape, what: str) -> Array:
    """Numbers (m,), a matrix row by row, as an answer. what: the numbers in messages. Raises Unreadable."""
    known = math.prod(size for size in shape if size is not None)
    if numbers.size == 0 or (numbers.size % known if None in shape else numbers.size != known):
        expected = f"a multiple of {known}" if None in shape else f"{known}"
        raise UnreadableAnswer(f"{what}: {counted(numbers.size, 'number')}, expected {expected}")
    return numbers.reshape([-1 if size is None else size for size in shape])


def number_text(x: float) -> str:
    """The number with 17 digits, which make it the same number again."""
    return f"{x:.17g}"


PROTOCOLS_BY_NAME = {"plain": Protocol(_plain_question, _plain_answer), "json": Protocol(_json_question, _json_answer)}
"""Protocols by name, as --protocol takes them."""
