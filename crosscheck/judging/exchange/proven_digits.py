"""Answers with proven digits, for test vectors of codes that compute with more than doubles."""

from __future__ import annotations

from dataclasses import dataclass

from crosscheck.exact import ExactArray, Truth
from crosscheck.judging.states import JudgedStates
from crosscheck.judging.verdicts.exact_answers import ExactAnswers
from crosscheck.quantities import Quantity
from crosscheck.quantities.measures import Chosen
from crosscheck.reference.subject import Subject


@dataclass(frozen=True)
class ProvenDigits:
    """How many digits are asked for, and of which truth (crosscheck.exact_values)."""

    count: int
    truth: Truth

    def of(self, known: Quantity, chosen: Chosen, robot: Subject, states: JudgedStates) -> ExactArray | None:
        """The answer at all states; None where the function has no exact form in these conventions."""
        answers = ExactAnswers(known, chosen, robot)
        return None if answers.refusal else answers.at(states, self.truth, self.count)
