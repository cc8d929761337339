"""Diagnoses of functions of motion, momentum and energy: what is wrong, by the same search as of torques."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.file_reading import FileFaults
from crosscheck.judging.judgment import Diagnosis
from crosscheck.judging.observing.references import relative_errors
from crosscheck.judging.searching.function_catalog import catalog_of, observed
from crosscheck.judging.searching.search import MIN_FITTED_ANSWERS, Search
from crosscheck.judging.verdicts.diagnosis import explained, holding_alone
from crosscheck.judging.verdicts.verdicts import Judged
from crosscheck.quantities.measures import Chosen

MAX_READINGS = 3
"""Number of ways to read the answers that are tried, those with the smallest errors."""


def diagnose_function(
    found: Judged, of_file: Callable[[], FileFaults], precision: float, bound: float, evidence: str
) -> list[Diagnosis]:
    """What is wrong, where one fault gives the answers at all states; else nothing."""
    known, states = found.function.known, found.states
    for chosen in _nearest(found):
        catalog = catalog_of(known, states, chosen, of_file())
        if catalog is None:
            return []
        rows = _experiments(found)
        experiments = observed(known, found.answer[rows], states.rows(rows), chosen, "answers")
        judged = observed(known, found.answer, states, chosen, "judged")
        search = Search(states.model, catalog, experiments, judged, precision, bound)
        holding = holding_alone(search, search.alone(search.nothing()))
        if holding:
            return explained(found.function.name, search, holding, evidence)
    return []


def _experiments(found: Judged) -> NDArray[np.intp]:
    """Numbers of the states to which faults are fitted: more where an answer is one number, or few."""
    rows = found.states.trial_rows
    missing = MIN_FITTED_ANSWERS // max(1, found.answer[0].size) + 1 - len(rows)
    others = np.setdiff1d(np.flatnonzero(found.states.ordinary), rows)[: max(0, missing)]
    return np.concatenate([rows[: len(rows) // 2], others, rows[len(rows) // 2 :]])


def _nearest(found: Judged) -> list[Chosen]:
    """The ways to read the answers, those with the smallest errors first."""
    known, states = found.function.known, found.states

    def middle(chosen: Chosen) -> float:
        ours = known.of_graphdyn(states, chosen)
        return float(np.median(relative_errors(known, found.answer, ours, states, chosen)))

    return sorted(known.readings(found.declared), key=middle)[:MAX_READINGS]
