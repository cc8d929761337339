"""Answers with proven digits, for test vectors of codes that compute with more than doubles."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from crosscheck.exact import ExactArray, Truth
from crosscheck.judging.states import JudgedStates
from crosscheck.judging.verdicts.exact_answers import ExactAnswers, has_exact_values
from crosscheck.quantities import Quantity
from crosscheck.quantities.measures import Chosen
from crosscheck.reference.subject import Subject
from graphdyn import InvalidInput


@dataclass(frozen=True)
class ProvenDigits:
    """How many digits are asked for, and of which truth (crosscheck.exact_values)."""

    count: int
    truth: Truth

    def refuse_inexact(self, functions: Iterable[Quantity]) -> None:
        """Raises InvalidInput, naming the first function without an exact form."""
        for known in functions:
            if not has_exact_values(known):
                raise InvalidInput(f"{known.name} has no exact form; leave it out of --for, or omit --digits")

    def of(self, known: Quantity, chosen: Chosen, robot: Subject, states: JudgedStates) -> ExactArray | None:
        """The answer at all states; None where the function has no exact form in these conventions."""
        answers = ExactAnswers(known, chosen, robot)
        return None if answers.refusal else answers.at(states, self.truth, self.count)
