"""The search for a fault that any function of the table may have, by comparing answers."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import chain

import numpy as np

from crosscheck.judging.answer_faults import AnswerFault, faults, fitted_faults
from crosscheck.judging.conventions import relative_errors
from crosscheck.judging.functions.known_function import Chosen, KnownFunction
from crosscheck.judging.judged_states import JudgedStates
from graphdyn.layout import Array

FIRST = 5
"""Number of states at which a fault is tried before it is tried at all of them."""


@dataclass(frozen=True)
class FoundFault:
    """A fault that gives the answers of a function, the relative error that it leaves, and how the answers are read."""

    kind: str
    message: str
    remedy: str
    left: float
    chosen: Chosen = field(default_factory=dict)


def answer_fault(
    known: KnownFunction, answer: Array, states: JudgedStates, declared: Chosen, bound: float
) -> FoundFault | None:
    """The first fault that leaves no more than the bound, by any reading in keeping with the declared conventions."""
    few = np.arange(len(states.q)) < FIRST
    for chosen in known.readings(declared):
        ours = known.ours(states, chosen)
        for fault in chain(faults(known, states), fitted_faults(known, answer, ours, chosen, states.model)):

            def left(some: JudgedStates, given: Array, fault: AnswerFault = fault, chosen: Chosen = chosen) -> float:
                return float(relative_errors(known, given, fault.answers(some, chosen), some, chosen).max())

            if left(states.rows(few), answer[few]) <= bound and (rest := left(states, answer)) <= bound:
                return FoundFault(fault.kind, fault.message, fault.remedy, rest, chosen)
    return None
