"""The verdict on a function under test: its answers beside those of the references, and its own if asked again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain, combinations

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.calls.batches import mixed_rows
from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.judgment import Diagnosis, FailedState, JudgedFunction, WorstCall, largest_errors
from crosscheck.judging.observing.function_under_test import Answers, FunctionFailure, FunctionUnderTest
from crosscheck.judging.observing.references import (
    BACKWARD_SCALE,
    FoundConventions,
    References,
    backward_errors,
    found_conventions,
    relative_errors,
)
from crosscheck.judging.searching.found_fault import FIRST_TRIAL_STATES, FoundFault
from crosscheck.judging.special_states import earlier_calls, in_a_row
from crosscheck.judging.states import JudgedStates, joined
from crosscheck.quantities import LOADS, argument_at
from crosscheck.quantities.measures import Chosen
from graphdyn.layout import Array

N_REPEATS = 6
"""Number of times that one question is asked in a row."""

MAX_SETTLING_SHARE = 0.75
"""Part of the change before that answers to one question may still change by, if they settle."""

PURE_FUNCTION_REMEDY = "compute every answer from the arguments alone; clear what is kept between calls"


@dataclass(frozen=True, eq=False)
class Judged:
    """A verdict, and what it is about.

    declared: conventions that the function must follow
    asked: all states, answers: what came back
    states: those that were answered
    conventions: of the answers, with those of graphdyn read alike
    answer: the answers there; references: those of the reference implementations   (N, …)
    """

    function: FunctionUnderTest
    declared: Chosen
    verdict: JudgedFunction
    asked: JudgedStates
    answers: Answers
    states: JudgedStates
    conventions: FoundConventions
    answer: Array
    references: Mapping[str, Array]


def repeated(function: FunctionUnderTest, first: Answers, states: JudgedStates, chosen: Chosen) -> Array:
    """Relative difference of the second answer to each question from the first; all are asked in the reverse order.

    first: the answers, states: all that were asked. One number per answered state (M,); infinite for one that has no
    answer the second time.
    """
    arguments = function.known.arguments_at(states)
    differences = np.full(len(states.q), np.inf)
    try:
        again = function.ask(*(x[::-1] for x in arguments))
    except FunctionFailure:
        return differences[first.answered]
    both = first.answered & again.answered[::-1]
    here, there = (x.values[both[x.answered]] for x in (first, _reversed(again)))
    alike = np.array([np.array_equal(x, y, equal_nan=True) for x, y in zip(here, there, strict=True)], dtype=bool)
    numbers = np.array([bool(np.isfinite([x, y]).all()) for x, y in zip(here, there, strict=True)], dtype=bool)
    found = np.where(alike, 0.0, np.inf)
    differ = numbers & ~alike
    if differ.any():
        some = states.rows(both).rows(differ)
        found[differ] = relative_errors(function.known, there[differ], here[differ], some, chosen)
    differences[both] = found
    return differences[first.answered]


def _reversed(answers: Answers) -> Answers:
    return replace(answers, values=answers.values[::-1], answered=answers.answered[::-1])


def kept_between_calls(found: Judged) -> Diagnosis:
    """What a function keeps whose answers differ the second time."""
    function, differences, bound = found.function, found.verdict.repeated, found.verdict.bound
    differing = int((differences > bound).sum())
    evidence = f"asked again in the reverse order, {differing} of {len(differences)} answers differ, " + (
        f"by a relative {differences.max():.1e}" if np.isfinite(differences.max()) else "or fail"
    )

    def diagnosis(kind: str, message: str, left: float = np.inf) -> Diagnosis:
        return Diagnosis(function.name, kind, message, evidence, PURE_FUNCTION_REMEDY, left)

    worst = np.flatnonzero(found.answers.answered)[int(differences.argmax())]
    rows = [np.repeat(x[worst : worst + 1], N_REPEATS, axis=0) for x in function.known.arguments_at(found.asked)]
    try:
        same = function.ask(*rows).values
    except FunctionFailure:
        return diagnosis("kept_state", "an answer depends on the calls before it")
    if mixed := mixed_rows(function, found.answers, found.asked, found.conventions.chosen, bound):
        return diagnosis(mixed.said.kind, mixed.said.message, mixed.left)
    if not _settles(same):
        return diagnosis("not_repeatable", "the same question, asked several times in a row, has different answers")
    if earlier := earlier_arguments(found, bound):
        return diagnosis(earlier.said.kind, earlier.said.message, earlier.left)
    return diagnosis("kept_state", "an answer depends on the calls before it")


def _settles(same: Array) -> bool:
    """Whether the last answers to one question are equal, or ever nearer to one another."""
    if np.array_equal(same[-1], same[-2], equal_nan=True):
        return True
    steps = np.abs(np.diff(same.reshape(len(same), -1), axis=0)).max(axis=1)
    return bool((steps[1:] <= MAX_SETTLING_SHARE * steps[:-1]).all())


def earlier_arguments(found: Judged, bound: float) -> FoundFault | None:
    """The fault that some arguments are those of an earlier call: all answers but the first show it."""
    function, first, states, chosen = found.function, found.answers, found.asked, found.conventions.chosen
    rest = first.answered & (np.arange(len(first.answered)) > 0)
    if not rest.any():
        return None
    few = rest & (np.arange(len(rest)) <= FIRST_TRIAL_STATES)

    def errors(rows: NDArray[np.bool_], some: JudgedStates, expected: Array) -> float:
        answer = first.values[rows[first.answered]]
        return float(relative_errors(function.known, answer, expected, some, chosen).max(initial=0.0))

    all_stale, some = list(_stale(function, states)), states.rows(few)
    at_few = function.known.of_graphdyn(joined([stale.rows(few) for _, stale in all_stale]), chosen)
    for (message, stale), expected in zip(all_stale, np.split(at_few, len(all_stale)), strict=True):
        if errors(few, some, expected) > bound:
            continue
        whole = errors(rest, states.rows(rest), function.known.of_graphdyn(stale.rows(rest), chosen))
        if whole <= bound:
            return FoundFault(FaultDescription("kept_state", message, PURE_FUNCTION_REMEDY), whole, chosen)
    return None


def _stale(function: FunctionUnderTest, states: JudgedStates) -> Iterator[tuple[str, JudgedStates]]:
    """States some of whose arguments are those of the call before, or of the first call."""
    names = function.arguments
    subsets = chain.from_iterable(combinations(names, size) for size in range(len(names), 0, -1))
    for subset in subsets:
        what = f"{' and '.join(subset)} {'is that' if len(subset) == 1 else 'are those'} of"
        yield f"{what} the call before", _with(states, subset, lambda x: np.concatenate([x[:1], x[:-1]]))
        yield f"{what} two calls before", _with(states, subset, lambda x: np.concatenate([x[:2], x[:-2]]))
        yield f"{what} the first call", _with(states, subset, lambda x: np.broadcast_to(x[:1], x.shape))
        if same := [name for name in names if name not in subset]:
            given, like = [argument_at(states, name) for name in same], f"with the same {' and '.join(same)}"
            for first, which in ((earlier_calls(*given), like), (in_a_row(*given), f"of those in a row {like}")):
                yield f"{what} the first call {which}", _with(states, subset, partial(np.take, indices=first, axis=0))


def _with(states: JudgedStates, names: tuple[str, ...], change: Callable[[Array], Array]) -> JudgedStates:
    return states.but(**{"loads" if name == LOADS else name: change(argument_at(states, name)) for name in names})


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
        references_differ={reference: errors(x, ours) for reference, x in others.items()},
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
    return Judged(function, declared, verdict, all_states, answers, states, found, answer, theirs)
