"""A deviating function, its answers, and the right ones."""

from __future__ import annotations

from dataclasses import dataclass, replace

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

    def at(self, rows: NDArray[np.intp]) -> Answered:
        """The same at some of the states."""
        return replace(self, states=self.states.rows(rows), answer=self.answer[rows], ours=self.ours[rows])

    def errors(self, expected: Array, chosen: Chosen | None = None) -> Array:
        """Relative errors of the answers against others, at all states (N,). Accelerations are compared as
        torques as well, like those of the references."""
        states, answer = self.states, self.answer
        found = relative_errors(self.known, answer, expected, states, self.chosen if chosen is None else chosen)
        if self.name != "forward_dynamics":
            return found
        torque = np.abs(states.mass @ (answer - expected)[..., None]).max(axis=(1, 2))
        solved = (np.abs(states.mass) @ np.abs(answer)[..., None]).max(axis=(1, 2))
        sizes = [np.abs(states.tau).max(axis=1), solved, np.abs(states.solved[2]).max(axis=(1, 2))]
        larger: Array = np.maximum(found, torque / np.maximum.reduce(sizes))
        return larger
