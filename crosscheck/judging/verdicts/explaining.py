"""What is wrong with a function under test whose answers deviate: the searches, one after the other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from crosscheck.judging.judgment import Diagnosis
from crosscheck.judging.observing.conventions import found_conventions, relative_errors
from crosscheck.judging.observing.deviation import MAX_NOISE_FACTOR, Deviation
from crosscheck.judging.observing.function_under_test import FunctionFailure, FunctionUnderTest
from crosscheck.judging.observing.observation import of_judged
from crosscheck.judging.observing.observing import observe
from crosscheck.judging.observing.precision import noise
from crosscheck.judging.observing.regions import region
from crosscheck.judging.searching.answer_faults import FoundFault, answer_fault
from crosscheck.judging.searching.own_faults import OWN_FAULTS
from crosscheck.judging.verdicts.diagnosis import diagnose
from crosscheck.judging.verdicts.repetition import earlier_arguments, kept_between_calls
from crosscheck.judging.verdicts.verdicts import Judged
from crosscheck.quantities.measures import Chosen
from urdf.reading import Misreadings

Readings = Callable[[], Misreadings | None]
Progress = Callable[[str], object]

MIN_ERROR_REDUCTION = 10.0
"""Factor by which a fault must lessen the largest error."""

MAX_ANSWER = 1e100
"""A number beyond this is no answer that a fault could be found in: squares of it overflow."""

WORST_STATE_REMEDY = "look at the worst state"


def diagnoses_of(
    function: FunctionUnderTest, found: Judged, declared: Chosen, readings: Readings, say: Progress
) -> list[Diagnosis]:
    """What is wrong with a function that does not agree.

    declared: conventions that the function must follow
    readings: gives the misreadings of the robot's file, None where it has none; say: called with what is done next
    """
    verdict, diagnoses = found.verdict, []
    if verdict.failures:
        diagnoses.append(_failures(function, found))
    if not verdict.repeats:
        chosen, differences = found.conventions.chosen, verdict.repeated
        kept = kept_between_calls(function, found.answers, found.asked, chosen, differences, verdict.bound)
        return [*diagnoses, kept]
    return [*diagnoses, *_of_numbers(function, found, declared, readings, say)]


def _failures(function: FunctionUnderTest, found: Judged) -> Diagnosis:
    failures, failed = found.verdict.failures, ~found.answers.answered
    where = region(failed, found.asked, function.known.arguments)
    message = f"no answer at {len(failures)} of {len(failed)} states{f', only where {where}' if where else ''}"
    remedy = "the other states are judged; these are listed with the function"
    return Diagnosis(function.name, "no_answer", message, failures[0].message, remedy, np.inf, "located")


def _of_numbers(
    function: FunctionUnderTest, found: Judged, declared: Chosen, readings: Readings, say: Progress
) -> list[Diagnosis]:
    """What is wrong with the numbers; empty if they agree."""
    name, verdict = function.name, found.verdict
    errors = verdict.largest_errors
    wrong = errors > verdict.bound
    if not wrong.any():
        return []
    unbounded = np.array([not (np.abs(answer) < MAX_ANSWER).all() for answer in found.answer])
    if unbounded.any():
        where = region(unbounded, found.states, function.known.arguments)
        evidence = f"{int(unbounded.sum())} of {len(wrong)} answers{f', only where {where}' if where else ''}"
        message = (
            "the answers are not finite" if not np.isfinite(found.answer).all() else f"answers beyond {MAX_ANSWER:g}"
        )
        return [Diagnosis(name, "not_finite", message, evidence, WORST_STATE_REMEDY, np.inf, "unknown")]
    where = region(wrong, found.states, function.known.arguments)
    count = f"{int(wrong.sum())} of {len(wrong)} states deviate{f', only where {where}' if where else ''}"

    def one(fault: FoundFault) -> list[Diagnosis]:
        read = ", ".join(f"{convention} '{way}'" for convention, way in fault.chosen.items())
        evidence = f"{count}{f'; answers read with {read}' if read else ''}"
        return [Diagnosis(name, fault.kind, fault.message, evidence, fault.remedy, fault.left)]

    if other := _other_convention(found, declared):
        return one(other)
    size = float(verdict.errors["graphdyn"].max())
    precision = noise(function, found.states)
    bound = min(max(verdict.bound, MAX_NOISE_FACTOR * precision), size / MIN_ERROR_REDUCTION)
    if earlier := earlier_arguments(function, found.answers, found.asked, found.conventions.chosen, bound):
        return one(earlier)
    own = OWN_FAULTS.get(name)
    if own is not None and (fault := own(found.answer, found.conventions.ours, found.states, bound)):
        return one(fault)
    by_terms = [
        replace(diagnosis, evidence="; ".join(filter(None, (diagnosis.evidence, count))))
        for diagnosis in _of_terms(function, found, precision, readings, say)
    ]
    if by_terms and by_terms[0].status in ("confirmed", "candidate"):
        return by_terms
    if fault := answer_fault(function.known, found.answer, found.states, declared, bound):
        return one(fault)
    if where:
        message = f"the answers deviate only where {where}"
        return [
            Diagnosis(
                name,
                "region",
                message,
                count,
                "look for a case, a limit or a table that begins there",
                np.inf,
                "located",
            )
        ]
    return by_terms or [
        Diagnosis(
            name,
            "unknown",
            "no fault that is known here gives the answers",
            count,
            WORST_STATE_REMEDY,
            np.inf,
            "unknown",
        )
    ]


def _other_convention(found: Judged, declared: Chosen) -> FoundFault | None:
    """The answers follow another convention than the declared ones."""
    if not declared or found.conventions.fits:
        return None
    other = found_conventions(found.known, found.answer, found.states, {}, found.verdict.bound)
    if not other.fits:
        return None
    differing = {name: other.said[name] for name, way in declared.items() if way not in other.said[name].split(" or ")}
    said = ", ".join(f"{name} is '{way}', not '{declared[name]}'" for name, way in differing.items())
    left = relative_errors(
        found.known, found.answer, found.known.of_graphdyn(found.states, other.chosen), found.states, other.chosen
    )
    message = f"the answers follow another convention: {said}"
    return FoundFault("convention", message, "convert them", float(left.max()))


def _of_terms(
    function: FunctionUnderTest, found: Judged, precision: float, readings: Readings, say: Progress
) -> list[Diagnosis]:
    """Diagnoses from experiments, for functions that are parts of the equations of motion; empty for others."""
    name, states = function.name, found.states
    torque = np.maximum(np.sqrt(np.mean(states.inverse.tau**2, axis=0)), np.finfo(float).tiny)
    try:
        observed = observe(function, states.model, states.trial, torque)
    except np.linalg.LinAlgError:
        message = "the answers do not determine a mass matrix: M⁻¹ from unit torques is singular"
        return [Diagnosis(name, "unknown", message, "", WORST_STATE_REMEDY, np.inf, "unknown")]
    except FunctionFailure as failure:
        return [
            Diagnosis(
                name, "unknown", f"an experiment has no answer: {failure}", "", WORST_STATE_REMEDY, np.inf, "unknown"
            )
        ]
    if observed is None:
        return []
    judged = of_judged(name, found.answer, states)
    deviation = Deviation(name, states.model, states.trial, observed, judged, readings, precision, found.verdict.bound)
    return diagnose(deviation, say)
