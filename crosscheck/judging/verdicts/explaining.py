"""What is wrong with a function under test whose answers deviate: the searches, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.calls.answered import Answered
from crosscheck.judging.calls.batches import mixed_rows
from crosscheck.judging.calls.clipping import clipped_arguments
from crosscheck.judging.calls.joint_torques import added_torques, with_added_torques
from crosscheck.judging.calls.search import found_in_calls, told_of_calls
from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.faults.file_reading import FileFaults
from crosscheck.judging.judgment import Diagnosis, DiagnosisStatus
from crosscheck.judging.observing.function_under_test import FunctionFailure
from crosscheck.judging.observing.noise import MAX_NOISE_FACTOR, noise
from crosscheck.judging.observing.observation import observe, of_judged
from crosscheck.judging.observing.references import found_conventions, relative_errors
from crosscheck.judging.searching.answer_faults import answer_fault, factor_fault, layout_fault
from crosscheck.judging.searching.found_fault import FoundFault
from crosscheck.judging.searching.own_faults import OWN_FAULTS
from crosscheck.judging.searching.parts import part_fault
from crosscheck.judging.special_states import conditions, only_where
from crosscheck.judging.verdicts.diagnosis import Deviation, diagnose, diagnosis_of
from crosscheck.judging.verdicts.functions import diagnose_function
from crosscheck.judging.verdicts.regions import region
from crosscheck.judging.verdicts.verdicts import Judged, earlier_arguments, kept_between_calls

OfFile = Callable[[], FileFaults]
Progress = Callable[[str], object]

MIN_ERROR_REDUCTION = 10.0
"""Factor by which a fault must lessen the largest error."""

MAX_ANSWER = 1e100
"""A number beyond this is no answer that a fault could be found in: squares of it overflow."""

LOCATED_KINDS = ("mixed_rows", "joint_torque", "residual")
"""Kinds of what is certain, and gives no numbers."""

WORST_STATE_REMEDY = "look at the worst state"

SPECIAL_STATE_REMEDY = "look for a shortcut, a division, a threshold, or a number kept between calls"


def diagnoses_of(found: Judged, of_file: OfFile, say: Progress) -> list[Diagnosis]:
    """What is wrong with a function that does not agree.

    of_file: gives the faults in reading the robot's file; say: called with what is done next
    """
    verdict, diagnoses = found.verdict, []
    if verdict.failures:
        diagnoses.append(_failures(found))
    if not verdict.repeats:
        return [*diagnoses, kept_between_calls(found)]
    return [*diagnoses, *_of_numbers(found, of_file, say)]


def _failures(found: Judged) -> Diagnosis:
    failures, failed = found.verdict.failures, ~found.answers.answered
    where = region(failed, found.asked, found.function.known.arguments)
    message = f"no answer at {len(failures)} of {len(failed)} states{_only(where)}"
    remedy = "the other states are judged; these are listed with the function"
    return Diagnosis(found.function.name, "no_answer", message, failures[0].message, remedy, np.inf, "located")


def _only(where: str | None) -> str:
    return f", only where {where}" if where else ""


def _of_numbers(found: Judged, of_file: OfFile, say: Progress) -> list[Diagnosis]:
    """What is wrong with the numbers; empty if they agree."""
    function, verdict = found.function, found.verdict
    name, declared = function.name, found.declared
    wrong = verdict.largest_errors > verdict.bound
    if not wrong.any():
        return []
    unbounded = np.array([not (np.abs(answer) < MAX_ANSWER).all() for answer in found.answer])
    if unbounded.any():
        special = _special(unbounded, found)
        where = region(unbounded, found.states, function.known.arguments)
        evidence = f"{int(unbounded.sum())} of {len(wrong)} answers{f', {special}' if special else _only(where)}"
        finite = np.isfinite(found.answer).all()
        message = f"answers beyond {MAX_ANSWER:g}" if finite else "the answers are not finite"
        message += f" {special}" if special else _only(where)
        return [_unknown(name, message, evidence, "not_finite")]
    where = region(wrong, found.states, function.known.arguments)
    count = f"{int(wrong.sum())} of {len(wrong)} states deviate{_only(where)}"

    def one(fault: FoundFault) -> list[Diagnosis]:
        read = ", ".join(f"{convention} '{way}'" for convention, way in fault.chosen.items())
        evidence = f"{count}{f'; answers read with {read}' if read else ''}"
        status: DiagnosisStatus = "located" if fault.said.kind in LOCATED_KINDS else "confirmed"
        return [diagnosis_of(name, fault.said, evidence, fault.left, status)]

    if other := _other_convention(found):
        return one(other)
    if special := _special(wrong, found):
        if earlier := earlier_arguments(found, verdict.bound):
            return one(earlier)
        right = int(found.states.ordinary.sum())
        message = f"right at {right} ordinary states, wrong {special}"
        return [Diagnosis(name, "special_state", message, count, SPECIAL_STATE_REMEDY, np.inf, "located")]
    size = float(verdict.errors["graphdyn"].max())
    precision = noise(function, found.states)
    bound = min(max(verdict.bound, MAX_NOISE_FACTOR * precision), size / MIN_ERROR_REDUCTION)
    if earlier := earlier_arguments(found, bound):
        return one(earlier)
    if mixed := mixed_rows(function, found.answers, found.asked, found.conventions.chosen, bound):
        return one(mixed)
    given = Answered(
        function,
        found.states,
        found.answer,
        found.conventions.ours,
        found.conventions.chosen,
        declared,
        bound,
        precision,
    )
    if fault := layout_fault(function.known, found.answer, found.states, declared, bound):
        return one(fault)
    if fault := found_in_calls(given, verdict.bound):
        return one(fault)
    added = added_torques(given)
    if added and not added.plain:
        return one(added.fault or added.seen(given))
    own = OWN_FAULTS.get(name)
    if own is not None and (fault := own(found.answer, found.conventions.ours, found.states, bound)):
        return one(fault)
    stages = _of_terms(found, precision, of_file, say)
    if by_terms := next(stages, []):
        return with_added_torques(_counted(by_terms, count), added)
    if fault := ((added.fault or added.seen(given)) if added else None) or clipped_arguments(given):
        return one(fault)
    if fault := answer_fault(function.known, found.answer, found.states, declared, bound):
        return one(fault)
    if fault := part_fault(function.known, found.answer, found.states, declared, bound):
        return one(fault)
    if by_function := diagnose_function(found, of_file, precision, bound, count):
        return by_function
    by_terms = _counted(next(stages, []), count)
    if by_terms and by_terms[0].status in ("confirmed", "candidate"):
        return by_terms
    if fault := factor_fault(function.known, found.answer, found.states, declared, bound):
        return one(fault)
    if where:
        message = f"the answers deviate only where {where}"
        remedy = "look for a case, a limit or a table that begins there"
        return [Diagnosis(name, "region", message, count, remedy, np.inf, "located")]
    if fault := told_of_calls(given):
        return one(fault)
    return by_terms or [_unknown(name, "no fault that is known here gives the answers", count)]


def _counted(diagnoses: list[Diagnosis], count: str) -> list[Diagnosis]:
    """The diagnoses, with the number of states that deviate as further evidence."""
    return [replace(one, evidence="; ".join(filter(None, (one.evidence, count)))) for one in diagnoses]


def _special(deviating: NDArray[np.bool_], found: Judged) -> str | None:
    """What the deviating states have in common, where ordinary ones do not deviate; None where they do."""
    states = found.states
    if (deviating & states.ordinary).any():
        return None
    arrays = {name: getattr(states, name) for name in ("q", "v", "a", "tau")}
    where = only_where(deviating, conditions(states.labels, arrays, found.function.known.arguments))
    return where or f"at {int(deviating.sum())} special states"


def _unknown(name: str, message: str, evidence: str = "", kind: str = "unknown") -> Diagnosis:
    return Diagnosis(name, kind, message, evidence, WORST_STATE_REMEDY, np.inf, "unknown")


def _other_convention(found: Judged) -> FoundFault | None:
    """The answers follow another convention than the declared ones."""
    declared, known, states = found.declared, found.function.known, found.states
    if not declared or found.conventions.fits:
        return None
    other = found_conventions(known, found.answer, states, {}, found.verdict.bound)
    if not other.fits:
        return None
    differing = {name: other.said[name] for name, way in declared.items() if way not in other.said[name].split(" or ")}
    said = ", ".join(f"{name} is '{way}', not '{declared[name]}'" for name, way in differing.items())
    left = relative_errors(known, found.answer, other.ours, states, other.chosen)
    message = f"the answers follow another convention: {said}"
    return FoundFault(FaultDescription("convention", message, "convert them"), float(left.max()))


def _of_terms(found: Judged, precision: float, of_file: OfFile, say: Progress) -> Iterator[list[Diagnosis]]:
    """Diagnoses from experiments, for functions that are parts of the equations of motion, by one fault and then by
    two; none for others."""
    function, name, states = found.function, found.function.name, found.states
    tau = states.answer("inverse_dynamics", loaded=True).tau
    torque = np.maximum(np.sqrt(np.mean(tau**2, axis=0)), np.finfo(float).tiny)
    try:
        observed = observe(function, states.trial, torque)
    except np.linalg.LinAlgError:
        yield []
        yield [_unknown(name, "the answers do not determine a mass matrix: M⁻¹ from unit torques is singular")]
        return
    except FunctionFailure as failure:
        yield []
        yield [_unknown(name, f"an experiment has no answer: {failure}")]
        return
    if observed is not None:
        judged = of_judged(name, found.answer, states)
        deviation = Deviation(name, states.trial, observed, judged, of_file, precision, found.verdict.bound)
        yield from diagnose(deviation, say)
