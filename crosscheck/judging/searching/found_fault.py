"""A fault of a function that gives its answers, before and after it is found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities.measures import Chosen
from graphdyn.layout import Array

Answering = Callable[[JudgedStates, Chosen], Array]
"""Answers of a function with a fault (N, …)."""


@dataclass(frozen=True, eq=False)
class AnswerFault:
    """One fault: its kind, message and remedy, and the answers of a function that has it.

    undefined: states at which such a function may answer anything (N,)
    """

    kind: str
    message: str
    remedy: str
    answers: Answering
    undefined: Callable[[JudgedStates], NDArray[np.bool_]] | None = None


FIRST_TRIAL_STATES = 5
"""Number of states at which a fault is tried before it is tried at all of them."""


@dataclass(frozen=True)
class FoundFault:
    """A fault that gives the answers of a function, the relative error that it leaves, and how the answers are read."""

    said: FaultDescription
    left: float
    chosen: Chosen = field(default_factory=dict)
