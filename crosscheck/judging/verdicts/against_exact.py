"""A function under test beside exact values: at the states that decide, or at all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from crosscheck.exact import MAX_DIGITS, ExactArray, Truth, check_installed
from crosscheck.judging.exact_errors import MATRIX_FACTOR, VECTOR_FACTOR, ExactErrors
from crosscheck.judging.setting import Setting
from crosscheck.judging.verdicts.exact_answers import PROVEN_DIGITS, ExactAnswers, largest_of_groups
from crosscheck.judging.verdicts.verdicts import Judged
from crosscheck.quantities.scales import ratio
from crosscheck.quantities.tested_function import LongDecimal
from crosscheck.quantities.tolerances import AGREEMENT
from crosscheck.reference.subject import Subject
from graphdyn import GraphDynError, InvalidInput
from graphdyn.layout import Array

NEEDS_NO_PROOF = 1e-6
"""Relative error from which on a function is wrong by any measure."""

SINGLE_ULPS = 2.0**29
"""Ulps of double precision in one of single precision."""


def needs_exact_values(found: Judged) -> bool:
    """Whether the exact values at a few states are worth their time: the references disagree, the function is wrong by
    little, or its answers have more digits than doubles.
    """
    verdict = found.verdict
    if found.answers.decimals is not None:
        return True
    largest = max(float(errors.max()) for errors in (*verdict.errors.values(), *verdict.backward_errors.values()))
    return not verdict.references_agree or AGREEMENT.bound < largest < NEEDS_NO_PROOF


def with_exact_errors(found: Judged, robot: Subject, setting: Setting, notes: list[str]) -> Judged:
    """The same with what exact values say; notes: gets a note where they would decide and there are none"""
    said = against_exact(found, robot, everywhere=setting.exact, single=setting.precision == "single")
    if isinstance(said, str):
        notes.append(f"{found.function.name} is not judged by exact values: {said}")
        return found
    return replace(found, verdict=replace(found.verdict, exact=said))


def against_exact(found: Judged, robot: Subject, *, everywhere: bool, single: bool) -> ExactErrors | str:
    """The errors of a judged function, or why there are no exact values.

    everywhere: at all states with an answer; else where it is worst against each reference implementation, and where
        these differ most
    single: the function computes in single precision

    The truth is that of the robot's file; that of the model where the function is wrong for the file, and right for the
    model or nearer to it.
    """
    answers = ExactAnswers(found.function.known, found.conventions.chosen, robot)
    if answers.refusal is not None:
        return answers.refusal
    try:
        check_installed()
    except InvalidInput as error:
        return str(error)
    rows = np.flatnonzero(_finite(found.answer)) if everywhere else _deciding(found)
    if not len(rows):
        return "no answer is a finite number"
    tried: list[ExactErrors] = []
    refusals: list[str] = []
    for truth in answers.truths:
        try:
            tried.append(_errors(found, answers, rows, truth, everywhere=everywhere, single=single))
        except GraphDynError as error:
            refusals.append(str(error))
            continue
        if not tried[-1].wrong:
            return tried[-1]
    return min(tried, key=lambda errors: float(errors.most.max())) if tried else refusals[-1]


def _finite(answer: Array) -> NDArray[np.bool_]:
    found: NDArray[np.bool_] = np.all(np.isfinite(answer).reshape(len(answer), -1), axis=1)
    return found


def _deciding(found: Judged) -> NDArray[np.intp]:
    """Rows where the errors against a reference implementation are largest, or these differ most."""
    verdict, finite = found.verdict, _finite(found.answer)
    kinds = (verdict.errors, verdict.backward_errors, verdict.references_differ, verdict.references_differ_backward)
    sizes = [np.where(finite, errors, -1.0) for kind in kinds for errors in kind.values()]
    return np.unique([int(size.argmax()) for size in sizes]) if finite.any() else np.empty(0, dtype=np.intp)


def _errors(
    found: Judged,
    answers: ExactAnswers,
    rows: NDArray[np.intp],
    truth: Truth,
    *,
    everywhere: bool,
    single: bool,
) -> ExactErrors:
    states, answer = found.states.rows(rows), found.answer[rows]
    texts, given_digits = _decimals(found, rows)
    exact = answers.at(states, truth, min(PROVEN_DIGITS + (given_digits or 0), MAX_DIGITS))
    group = answers.groups(states)

    least, most = exact.errors(answer if texts is None else texts)
    of_inputs = largest_of_groups(answers.caused(states), group)
    caused = np.maximum(of_inputs, answers.of_summed_terms(exact.doubles(), states))
    caused = caused * (SINGLE_ULPS if single else 1.0)
    sizes = np.broadcast_to(answers.sizes(exact.doubles(), states), caused.shape)
    factor = VECTOR_FACTOR if answer.ndim <= 2 else MATRIX_FACTOR
    excess = ratio(largest_of_groups(least, group), factor * caused)
    errors = ratio(largest_of_groups(most, group), sizes)
    worst = np.where(excess.any(axis=1), excess.argmax(axis=1), errors.argmax(axis=1))[:, None]

    def of_worst(values: Array) -> Array:
        return np.take_along_axis(values, worst, axis=1)[:, 0]

    return ExactErrors(
        truth=truth,
        everywhere=everywhere,
        states=np.flatnonzero(found.answers.answered)[rows],
        least=of_worst(ratio(largest_of_groups(least, group), sizes)),
        most=of_worst(errors),
        caused=of_worst(ratio(caused, sizes)),
        references={
            name: ratio(largest_of_groups(exact.errors(theirs[rows])[1], group), sizes).max(axis=1)
            for name, theirs in found.references.items()
        },
        scale=answers.scale,
        rounded=float(exact.is_correctly_rounded(answer).mean()),
        ulps=_ulps_of_worst(exact, most, sizes[:, group]),
        factor=factor,
        given_digits=given_digits,
    )


def _decimals(found: Judged, rows: NDArray[np.intp]) -> tuple[NDArray[np.object_] | None, int | None]:
    """The answers as texts, where some have more digits than doubles, and how many digits they have at most."""
    if found.answers.decimals is None:
        return None, None
    given = found.answers.decimals[rows]
    texts = [x.text if isinstance(x, LongDecimal) else float(x) for x in given.ravel()]
    digits = max((x.digits for x in given.ravel() if isinstance(x, LongDecimal)), default=None)
    kept = np.array(texts, dtype=object).reshape(given.shape)
    return (None, None) if digits is None else (kept, digits)


def _ulps_of_worst(exact: ExactArray, most: Array, sizes: Array) -> float:
    """How many ulps the number with the largest error is from the exact one. sizes: what errors are relative to"""
    errors = most.reshape(sizes.shape)
    worst = np.unravel_index(ratio(errors, sizes).argmax(), sizes.shape)
    return float(errors[worst] / np.spacing(np.abs(exact.doubles().reshape(sizes.shape)[worst])))
