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
from crosscheck.judging.searching.function_catalog import FunctionFaults, observed
from crosscheck.judging.searching.search import MANY_ANSWERS, MIN_FITTED_ANSWERS, Search
from crosscheck.judging.verdicts.diagnosis import explained, holding_alone
from crosscheck.judging.verdicts.verdicts import Judged
from crosscheck.quantities import FUNCTIONS
from crosscheck.quantities.measures import Chosen

MAX_READINGS = 3
"""Number of ways to read the answers that are tried, those with the smallest errors, besides those that look right."""


def diagnose_function(
    found: Judged, of_file: Callable[[], FileFaults], precision: float, bound: float, evidence: str
) -> list[Diagnosis]:
    """What is wrong, where one fault gives the answers at all states; else nothing."""
    name, states = found.function.name, found.states
    if name in ENERGIES_PER_PARAMETER:
        found = _times_parameters(found)
    known = found.function.known
    nearest = _nearest(found)
    if formulation_of(known.name, states.model, states.frame, nearest[0]) is None:
        return []
    with np.errstate(all="ignore"):  # a fault may divide by nothing
        for search in _searches(found, nearest, FunctionFaults.of(known, states, of_file()), precision, bound):
            if holding := holding_alone(search, search.alone(search.nothing())):
                return explained(name, search, holding, evidence)
    return []


ENERGIES_PER_PARAMETER = {
    "kinetic_energy_regressor": "kinetic_energy",
    "potential_energy_regressor": "potential_energy",
}
"""What these are with the inertial parameters of the robot."""


def _times_parameters(found: Judged) -> Judged:
    """The energies that a regressor gives with the parameters of the robot, from the usual zero."""
    known = FUNCTIONS[ENERGIES_PER_PARAMETER[found.function.name]]
    usual = {name: ways[0] for name, ways in known.conventions.items()}
    answer = found.answer @ found.states.model.inertial_parameters
    return replace(found, function=replace(found.function, known=known), answer=answer, declared=usual)


def _searches(
    found: Judged, nearest: Sequence[Chosen], given: FunctionFaults, precision: float, bound: float
) -> Iterator[Search]:
    """Searches of the nearest way to read the answers, of those that explain something at first sight, of the next."""

    def read(chosen: Chosen) -> Search:
        rows = _experiments(found)
        experiments = observed(given.known, found.answer[rows], found.states.rows(rows), chosen, "answers")
        judged = observed(given.known, found.answer, found.states, chosen, "judged")
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
