"""The verdict on one function under test: its answers beside those of the reference implementations."""

from __future__ import annotations

from dataclasses import dataclass

from crosscheck.judging.judgment import FailedState, JudgedFunction, WorstCall, largest_errors
from crosscheck.judging.observing.conventions import FoundConventions, found_conventions, relative_errors
from crosscheck.judging.observing.function_under_test import Answers, FunctionUnderTest
from crosscheck.judging.observing.references import BACKWARD_SCALE, References, backward_errors
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.judging.verdicts.repetition import repeated
from crosscheck.quantities import Quantity
from crosscheck.quantities.measures import Chosen
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class Judged:
    """A verdict, and what it is about.

    asked: all states, answers: what came back
    states: those that were answered
    conventions: of the answers, with those of graphdyn read alike
    answer: the answers there                               (N, …)
    """

    known: Quantity
    verdict: JudgedFunction
    asked: JudgedStates
    answers: Answers
    states: JudgedStates
    conventions: FoundConventions
    answer: Array


def judged(
    function: FunctionUnderTest, answers: Answers, references: References, declared: Chosen, tolerance: float
) -> Judged:
    """references: at all states; declared: conventions that are known."""
    known, answer = function.known, answers.values
    all_states = references.states
    references = references.at(answers.answered)
    states = references.states
    found = found_conventions(known, answer, states, declared, tolerance)
    theirs = references.answers(known, found.chosen, found.ours)
    others = {reference: x for reference, x in theirs.items() if reference != "graphdyn"}
    ours = theirs["graphdyn"]

    def errors(x: Array, y: Array) -> Array:
        return relative_errors(known, x, y, states, found.chosen)

    def backward(x: Array, reference: str) -> Array:
        return backward_errors(x, references.required(reference), states)

    solved = known.name == "forward_dynamics"
    errors_of = {reference: errors(answer, x) for reference, x in theirs.items()}
    backward_of = {reference: backward(answer, reference) for reference in theirs if solved}
    worst = int(largest_errors(errors_of, backward_of).argmax())
    row = [x[worst] for x in known.arguments_at(states)]
    verdict = JudgedFunction(
        name=known.name,
        errors=errors_of,
        references_differ={
            reference: relative_errors(known, x, ours, states, found.chosen) for reference, x in others.items()
        },
        backward_errors=backward_of,
        references_differ_backward={reference: backward(x, "graphdyn") for reference, x in others.items() if solved},
        bound=tolerance,
        scale=known.judged_relative_to,
        backward_scale=BACKWARD_SCALE if solved else "",
        worst=WorstCall(
            {argument: tuple(x.ravel().tolist()) for argument, x in function.function_arguments(row).items()},
            tuple(ours[worst].ravel().tolist()),
            tuple(answer[worst].ravel().tolist()),
        ),
        repeated=repeated(function, answers, all_states, found.chosen),
        conventions=found.said,
        code=known.code_for(found.chosen, states.frame),
        failures=tuple(FailedState(number, message) for number, message in answers.failures.items()),
    )
    return Judged(known, verdict, all_states, answers, states, found, answer)
