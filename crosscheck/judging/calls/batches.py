"""Functions that take all states at once and mix them: which other rows an answer depends on, found by asking.

Each row is asked alone. Where the answers differ from those in the batch, some rows of a small batch are exchanged, one
after the other, and the answer to one of them is compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import chain, combinations

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.observing.function_under_test import Answers, FunctionFailure, FunctionUnderTest
from crosscheck.judging.observing.references import relative_errors
from crosscheck.judging.searching.found_fault import FoundFault
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import LOADS, argument_at
from crosscheck.quantities.measures import Chosen
from graphdyn.layout import Array

BATCH_REMEDY = "compute every row from its own arguments alone"

ROW_IN_QUESTION = 2
SMALL_BATCH_ROWS = 5
"""A small batch, and the row of it that is compared: neither first nor last, nor beside them."""

PLACES = {0: "the first row", 1: "the row before", 3: "the row after", 4: "the last row"}
"""The other rows of the small batch as the one in question sees them."""

MAPS: dict[str, Callable[[NDArray[np.intp]], NDArray[np.intp]]] = {
    "the first row": lambda rows: 0 * rows,
    "the row before": lambda rows: np.roll(rows, 1),
    "the row after": lambda rows: np.roll(rows, -1),
    "the last row": lambda rows: 0 * rows + len(rows) - 1,
    "the same row in the reverse order": lambda rows: rows[::-1],
}
"""Which row an answer belongs to in place of its own."""

N_ALONE = 12
"""Number of rows that are asked alone."""


def mixed_rows(
    function: FunctionUnderTest, answers: Answers, states: JudgedStates, chosen: Chosen, bound: float
) -> FoundFault | None:
    """What a batched function takes from other rows; None where its rows stand alone.

    answers: to all states in one batch
    """
    if not function.batched or len(states.q) < SMALL_BATCH_ROWS or not answers.answered.all():
        return None
    arguments = function.known.arguments_at(states)
    try:
        if not np.array_equal(function.ask(*arguments).values, answers.values, equal_nan=True):
            return None  # it keeps something between calls
        few = np.unique(np.linspace(0, len(states.q) - 1, N_ALONE).astype(int))
        alone = np.concatenate([function.ask(*(x[k : k + 1] for x in arguments)).values for k in few])
        some = states.rows(few)
        if relative_errors(function.known, answers.values[few], alone, some, chosen).max() <= bound:
            return None
        matters = _rows_that_matter(function, arguments)
    except FunctionFailure:
        return None
    for message, changed in _other_rows(function, states):
        expected = function.known.of_graphdyn(changed, chosen)
        edge = (
            np.arange(len(few))
            if "row before" not in message and "row after" not in message
            else np.arange(1, len(few) - 1)
        )
        here = relative_errors(function.known, answers.values[few], expected[few], some, chosen)
        if here[edge].max() > bound:
            continue
        left = float(relative_errors(function.known, answers.values, expected, states, chosen)[1:-1].max())
        if left <= bound:
            return FoundFault(FaultDescription("mixed_rows", f"{BEGINNING}: {message}", BATCH_REMEDY), left, chosen)
    right = (
        relative_errors(function.known, alone, function.known.of_graphdyn(some, chosen), some, chosen).max() <= bound
    )
    message = BEGINNING + (f": of {matters}" if matters else "")
    message += "; each row alone is right" if right else ""
    return FoundFault(FaultDescription("mixed_rows", message, BATCH_REMEDY), np.inf, chosen)


BEGINNING = "an answer depends on the other rows of its batch"


def _rows_that_matter(function: FunctionUnderTest, arguments: tuple[Array, ...]) -> str:
    """The rows of a small batch that change the answer to the compared one, in words; "" for all of them."""
    base = np.arange(SMALL_BATCH_ROWS)
    here = function.ask(*(x[base] for x in arguments)).values[ROW_IN_QUESTION]
    mattering = []
    for place, said in PLACES.items():
        rows = base.copy()
        rows[place] = len(arguments[0]) - 1
        there = function.ask(*(x[rows] for x in arguments)).values[ROW_IN_QUESTION]
        if not np.array_equal(here, there):
            mattering.append(said)
    return " and ".join(mattering) if len(mattering) < len(PLACES) else ""


def _other_rows(function: FunctionUnderTest, states: JudgedStates) -> Iterator[tuple[str, JudgedStates]]:
    """States some of whose arguments are those of other rows."""
    rows, names = np.arange(len(states.q)), function.arguments
    subsets = chain.from_iterable(combinations(names, size) for size in range(len(names), 0, -1))
    for subset in subsets:
        what = (
            "it is that"
            if subset == names
            else f"its {' and '.join(subset)} {'is that' if len(subset) == 1 else 'are those'}"
        )
        for whose, other in MAPS.items():
            arrays = {"loads" if x == LOADS else x: argument_at(states, x)[other(rows)] for x in subset}
            yield f"{what} of {whose}", states.but(**arrays)
