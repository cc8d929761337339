"""Diagnoses of functions of motion, momentum and energy: what is wrong, by the same search as of torques."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.file_reading import FileFaults
from crosscheck.judging.functions.table import formulation_of
from crosscheck.judging.judgment import Diagnosis
from crosscheck.judging.observing.references import relative_errors
from crosscheck.judging.searching.function_catalog import FunctionFaults, as_usual, observed
from crosscheck.judging.searching.search import MANY_ANSWERS, MIN_FITTED_ANSWERS, Search
from crosscheck.judging.verdicts.diagnosis import explained, holding_alone
from crosscheck.judging.verdicts.per_parameter import GIVEN_BY, read_with_parameters
from crosscheck.judging.verdicts.verdicts import Judged
from crosscheck.quantities.measures import Chosen

MAX_READINGS = 3
"""Number of ways to read the answers that are tried, those with the smallest errors, besides those that look right."""


def diagnose_function(
    found: Judged, of_file: Callable[[], FileFaults], precision: float, bound: float, evidence: str
) -> list[Diagnosis]:
    """What is wrong, where one fault gives the answers at all states; else nothing."""
    name, links = found.function.name, of_file
    if name in GIVEN_BY:
        found, links = read_with_parameters(found), lambda: replace(of_file(), links=())
    known, states = found.function.known, found.states
    nearest = _nearest(found)
    if formulation_of(known.name, states.model, states.frame, nearest[0]) is None:
        return []
    with np.errstate(all="ignore"):  # a fault may divide by nothing
        for search in _searches(found, nearest, FunctionFaults.of(known, states, links()), precision, bound):
            if holding := holding_alone(search, search.alone(search.nothing())):
                return explained(name, search, holding, evidence)
    return []


def _searches(
    found: Judged, nearest: Sequence[Chosen], given: FunctionFaults, precision: float, bound: float
) -> Iterator[Search]:
    """Searches of the nearest way to read the answers, of those that explain something at first sight, of the next."""

    rows = _experiments(found)

    def read(way: Chosen) -> Search:
        answer, chosen = as_usual(given.known, found.answer, way)
        experiments = observed(given.known, answer[rows], found.states.rows(rows), chosen, "answers")
        judged = observed(given.known, answer, found.states, chosen, "judged")
        return Search(found.states.model, given.catalog(chosen), experiments, judged, precision, bound)

    yield read(nearest[0])
    others = [read(chosen) for chosen in nearest[1:]]
    likely = [search for search in others if search.looks_explained()]
    yield from likely
    yield from [search for search in others if search not in likely][: MAX_READINGS - 1]


def _experiments(found: Judged) -> NDArray[np.intp]:
    """Numbers of the states to which faults are fitted: more where an answer is one number, or few."""
    rows = found.states.trial_rows
    if found.answer[0].size >= MANY_ANSWERS:
        return rows[[0, -1]]
    missing = MIN_FITTED_ANSWERS // max(1, found.answer[0].size) + 1 - len(rows)
    others = np.setdiff1d(np.flatnonzero(found.states.ordinary), rows)[: max(0, missing)]
    return np.concatenate([rows[: len(rows) // 2], others, rows[len(rows) // 2 :]])


def _nearest(found: Judged) -> list[Chosen]:
    """The ways to read the answers, those with the smallest errors first."""
    known, states = found.function.known, found.states

    def middle(chosen: Chosen) -> float:
        ours = known.of_graphdyn(states, chosen)
        return float(np.median(relative_errors(known, found.answer, ours, states, chosen)))

    return sorted(known.readings(found.declared), key=middle)
