"""What is wrong with a function under test whose answers deviate: the searches, one after the other.

The region of the states at which it deviates lies beyond a threshold of one quantity, or of two. All thresholds of all
quantities are tried, of one and of two at a time: a decision tree of two levels, found exhaustively. A library of
decision trees grows the same tree greedily, and is a heavy dependency for these few lines.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, replace
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.faults.file_reading import FileFaults
from crosscheck.judging.judgment import Diagnosis
from crosscheck.judging.observing.function_under_test import FunctionFailure
from crosscheck.judging.observing.observation import observe, of_judged
from crosscheck.judging.observing.references import found_conventions, relative_errors
from crosscheck.judging.searching.answer_faults import FoundFault, answer_fault, factor_fault
from crosscheck.judging.searching.own_faults import OWN_FAULTS
from crosscheck.judging.special_states import ONE_JOINT, OTHER_STATES, conditions, only_where
from crosscheck.judging.states import JudgedStates
from crosscheck.judging.verdicts.diagnosis import MAX_NOISE_FACTOR, Deviation, diagnose, diagnosis_of, noise
from crosscheck.judging.verdicts.functions import diagnose_function
from crosscheck.judging.verdicts.verdicts import Judged, earlier_arguments, kept_between_calls
from graphdyn.layout import Array

MAX_CHANCE_PROBABILITY = 1e-3
"""Largest probability that states drawn without any rule would be separated as well."""

UNIT_SUFFIXES = {"q": "", "v": "/s", "a": "/s²"}


@dataclass(frozen=True, eq=False)
class RegionVariable:
    """A number of each state, in which a region may be bounded.

    name: in words; values: (N,); unit: with a blank before it, or ""
    limit: of this quantity, None where there is none
    """

    name: str
    values: Array
    unit: str
    limit: float | None = None


@dataclass(frozen=True, eq=False)
class Side:
    """One side of a threshold: all states that deviate, and others.

    inside: the states on this side (N,)
    """

    quantity: RegionVariable
    above: bool
    inside: NDArray[np.bool_]

    def said(self, among: NDArray[np.bool_]) -> str:
        """Such as "q of joint 'elbow' > 2 rad", "∣v∣ of joint 'elbow' > 2.4 rad/s (80 % of its limit)".

        among: the states that tell where the threshold is (N,)
        """
        values, limit = self.quantity.values, self.quantity.limit
        sign = 1.0 if self.above else -1.0
        x, y = sign * (sign * values[self.inside]).min(), sign * (sign * values[among & ~self.inside]).max()
        edge, part = roundest(x, y), ""
        if limit:
            percent = roundest(100 * x / limit, 100 * y / limit)
            edge, part = percent * limit / 100, f" ({percent:.12g} % of its limit)"
        return f"{self.quantity.name} {'>' if self.above else '<'} {edge:.6g}{self.quantity.unit}{part}"


def region(deviating: NDArray[np.bool_], states: JudgedStates, arguments: Collection[str]) -> str | None:
    """The region of the deviating states, in words; None where that has no such form, or may be chance.

    arguments: of the function
    """
    in_motion = ~np.isin(np.broadcast_to(states.labels, len(deviating)), (OTHER_STATES, ONE_JOINT))
    deviating, states = deviating[in_motion], states.rows(in_motion)  # at rest some function vanishes, right or wrong
    count, total = int(deviating.sum()), len(deviating)
    if not 0 < count < total:
        return None
    known = list(quantities(states, arguments))
    sides = [side for quantity in known for side in _sides(quantity, deviating)]
    by_chance = 1 / comb(total, count)  # that the deviating states are those beyond some threshold of one quantity
    if 2 * len(known) * by_chance > MAX_CHANCE_PROBABILITY:
        return None
    single = [side for side in sides if np.array_equal(side.inside, deviating)]
    if single:
        return single[0].said(np.ones(total, dtype=bool))
    if (2 * len(known)) ** 2 * total * by_chance > MAX_CHANCE_PROBABILITY:
        return None
    pairs = ((x, y) for x, y in combinations(sides, 2) if np.array_equal(x.inside & y.inside, deviating))
    found = next(pairs, None)
    if found is None:
        return None
    x, y = found
    return f"{x.said(y.inside)} and {y.said(x.inside)}"


def _sides(quantity: RegionVariable, deviating: NDArray[np.bool_]) -> Iterator[Side]:
    """The tightest threshold from either side that has all deviating states beyond it."""
    for above, values in ((True, quantity.values), (False, -quantity.values)):
        inside = values >= values[deviating].min()
        if not inside.all():
            yield Side(quantity, above, inside)


def quantities(states: JudgedStates, arguments: Collection[str]) -> Iterator[RegionVariable]:
    """Position, velocity, acceleration and speed of each joint; the largest of all joints."""
    model, moving = states.model, [name for name in "qva" if name in arguments]
    speed = np.array([joint.limits.velocity or np.nan for joint in model.joints])
    for k, joint in enumerate(model.joints):
        for name in moving:
            values, unit = getattr(states, name)[:, k], f" {'m' if joint.is_prismatic else 'rad'}{UNIT_SUFFIXES[name]}"
            limit = float(speed[k]) if name == "v" and speed[k] > 0 else None
            yield RegionVariable(f"{name} of joint '{joint.name}'", values, unit)
            yield RegionVariable(f"∣{name}∣ of joint '{joint.name}'", np.abs(values), unit, limit)
    if "v" in moving and (speed > 0).all():
        fastest = (np.abs(states.v) / speed).max(axis=1) * 100
        yield RegionVariable("the largest speed of a joint", fastest, " % of its limit")
    for name in moving:
        yield RegionVariable(f"the largest ∣{name}∣ of a joint", np.abs(getattr(states, name)).max(axis=1), "")


def roundest(x: float, y: float) -> float:
    """The roundest number between two numbers: a multiple of as large a power of ten as can be, or of half of one."""
    lower, upper = min(x, y), max(x, y)
    for digits in range(-6, 16):
        for step in (10.0**-digits, 0.5 * 10.0**-digits):
            rounded = round(float(np.ceil(lower / step)) * step, max(digits + 1, 0))
            if rounded <= upper:
                return rounded + 0.0  # not -0
    return lower


OfFile = Callable[[], FileFaults]
Progress = Callable[[str], object]

MIN_ERROR_REDUCTION = 10.0
"""Factor by which a fault must lessen the largest error."""

MAX_ANSWER = 1e100
"""A number beyond this is no answer that a fault could be found in: squares of it overflow."""

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
        message += f" {special}" if special else ""
        return [_unknown(name, message, evidence, "not_finite")]
    where = region(wrong, found.states, function.known.arguments)
    count = f"{int(wrong.sum())} of {len(wrong)} states deviate{_only(where)}"

    def one(fault: FoundFault) -> list[Diagnosis]:
        read = ", ".join(f"{convention} '{way}'" for convention, way in fault.chosen.items())
        evidence = f"{count}{f'; answers read with {read}' if read else ''}"
        return [diagnosis_of(name, fault.said, evidence, fault.left)]

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
    own = OWN_FAULTS.get(name)
    if own is not None and (fault := own(found.answer, found.conventions.ours, found.states, bound)):
        return one(fault)
    stages = _of_terms(found, precision, of_file, say)
    by_terms = next(stages, [])
    if by_terms:
        return _counted(by_terms, count)
    if fault := answer_fault(function.known, found.answer, found.states, declared, bound):
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
    return by_terms or [_unknown(name, "no fault that is known here gives the answers", count)]


def _counted(diagnoses: list[Diagnosis], count: str) -> list[Diagnosis]:
    """With the number of states that deviate as further evidence."""
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
