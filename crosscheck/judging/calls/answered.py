"""A deviating function, its answers, and the right ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.observing.function_under_test import FunctionUnderTest
from crosscheck.judging.observing.references import relative_errors
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import Quantity
from crosscheck.quantities.measures import Chosen
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Answered:
    """A function whose answers deviate.

    states: those that were answered; answer, ours: its answers and graphdyn's, read as chosen   (N, …)
    declared: conventions that it must follow
    bound: largest relative error that is none, at least ten times the noise of the function; noise: relative
    """

    function: FunctionUnderTest
    states: JudgedStates
    answer: Array
    ours: Array
    chosen: Chosen
    declared: Chosen
    bound: float
    noise: float

    @property
    def known(self) -> Quantity:
        return self.function.known

    @property
    def name(self) -> str:
        return self.function.name

    def errors(self, expected: Array, rows: NDArray[np.intp] | None = None, chosen: Chosen | None = None) -> Array:
        """Relative errors of the answers against others, at all states or some (N,). Accelerations are compared as
        torques as well, like those of the references."""
        states = self.states if rows is None else self.states.rows(rows)
        answer = self.answer if rows is None else self.answer[rows]
        found = relative_errors(self.known, answer, expected, states, self.chosen if chosen is None else chosen)
        if self.name != "forward_dynamics":
            return found
        torque = np.abs(states.mass @ (answer - expected)[..., None]).max(axis=(1, 2))
        solved = (np.abs(states.mass) @ np.abs(answer)[..., None]).max(axis=(1, 2))
        sizes = [np.abs(states.tau).max(axis=1), solved, np.abs(states.solved[2]).max(axis=(1, 2))]
        larger: Array = np.maximum(found, torque / np.maximum.reduce(sizes))
        return larger
