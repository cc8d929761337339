"""The questions that files hold: the states of one judgement, each with an id that depends on what is asked alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256

import numpy as np

from crosscheck.judging.foreign import ForeignFunction
from crosscheck.judging.functions.known_function import LOADS
from graphdyn import GraphDynError
from graphdyn.layout import Array

SMALLEST_ID = 10**11
IDS = 9 * 10**11
"""Ids are numbers of twelve digits, which every language holds exactly as a double."""

DIGITS = 9
"""Decimals of the numbers that an id depends on: not on the rounding of the machine that wrote the questions."""

ARGUMENTS = ("q", "v", "a", "tau", LOADS)
"""In the order of files."""


class SameId(GraphDynError):
    """Two different questions have the same id."""


@dataclass(frozen=True, eq=False)
class Question:
    """One call of a function.

    id: twelve digits; arguments: by name, in the joint order of the foreign code   (n,) or (n, 6)
    """

    id: int
    function: str
    arguments: Mapping[str, Array]


def question(function: str, arguments: Mapping[str, Array]) -> Question:
    """With its id."""
    said = [f"{name} " + " ".join(f"{x + 0.0:.{DIGITS}e}" for x in values.flat) for name, values in arguments.items()]
    digest = sha256("\n".join([function, *said]).encode()).digest()
    return Question(SMALLEST_ID + int.from_bytes(digest[:8], "big") % IDS, function, arguments)


def questions(function: ForeignFunction, arguments: Sequence[Array]) -> list[Question]:
    """The questions of one call with N states, each once. arguments: (N, …) each, in our joint order."""
    asked = (function.foreign_arguments(row) for row in zip(*arguments, strict=True))
    return once(question(function.name, given) for given in asked)


def once(asked: Iterable[Question]) -> list[Question]:
    """Each question once. Raises SameId."""
    by_id: dict[int, Question] = {}
    for one in asked:
        known = by_id.setdefault(one.id, one)
        if known.function != one.function or not all(
            np.allclose(known.arguments[name], x, rtol=10.0**-DIGITS, atol=0) for name, x in one.arguments.items()
        ):
            raise SameId(f"two questions have the id {one.id} by chance; give another --seed")
    return list(by_id.values())
