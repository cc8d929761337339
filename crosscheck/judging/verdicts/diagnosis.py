"""Diagnoses from observations: which faults, put into graphdyn, give the numbers of a function under test.

Where several do, it says what would tell them apart; where none does, which parts are explained, and where the rest is.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.judging.faults.fault import FaultDescription
from crosscheck.judging.faults.file_reading import FileFaults
from crosscheck.judging.faults.link_parameters import LINK_PARAMETERS
from crosscheck.judging.judgment import Diagnosis, DiagnosisStatus
from crosscheck.judging.observing.noise import MAX_NOISE_FACTOR, precision_said
from crosscheck.judging.observing.observation import Observation, of_experiments
from crosscheck.judging.searching.explanation import Explanation, firsts, preference
from crosscheck.judging.searching.search import Catalog, Search
from crosscheck.judging.slips.search import SLIP_SIZE
from crosscheck.judging.states import (
    EXPERIMENT_PARTS,
    EquationTerms,
    JudgedStates,
    deviations,
    scales,
    split,
    torques,
)
from crosscheck.judging.verdicts.distinguishing import same_code, same_everywhere, what_distinguishes


@dataclass(frozen=True, eq=False)
class Deviation:
    """A function that deviates, and what was seen of it.

    observed: the experiments
    judged: the answers at all judged states, None where no torques follow from them
    of_file: gives the faults in reading the robot's file, and its links
    noise: relative, of the function; tolerance: relative error that counts as agreement
    """

    function: str
    trial: JudgedStates
    observed: EquationTerms
    judged: Observation | None
    of_file: Callable[[], FileFaults]
    noise: float
    tolerance: float

    @property
    def bound(self) -> float:
        return max(self.tolerance, MAX_NOISE_FACTOR * self.noise)


def evidence_of(deviation: Deviation, before: Mapping[str, float], observed: EquationTerms, own: EquationTerms) -> str:
    said = [
        f"{EXPERIMENT_PARTS[part]}: {'agrees' if error <= deviation.bound else f'relative error {error:.1e}'}"
        for part, error in before.items()
    ]
    if "velocity" in before and before["velocity"] > deviation.bound:
        parts = ("velocity", "doubled")
        once, twice = (np.abs(getattr(observed, part) - getattr(own, part)).max() for part in parts)
        said.append(f"at twice the velocity the error is {twice / once:.3g} times as large")
    if deviation.noise > deviation.tolerance / MAX_NOISE_FACTOR:
        said.append(precision_said(deviation.noise))
    return "; ".join(said)


MAX_ALTERNATIVES = 4


def diagnosis_of(
    function: str,
    said: FaultDescription,
    evidence: str,
    left: float,
    status: DiagnosisStatus = "confirmed",
    also: Sequence[str] = (),
    apart: str = "",
) -> Diagnosis:
    """A fault as a diagnosis; the first of the others that give the same numbers are listed with it."""
    others = tuple(also[:MAX_ALTERNATIVES])
    return Diagnosis(
        function, said.kind, said.message, evidence, said.remedy, left, status, others, apart, said.numbers
    )


def unknown(deviation: Deviation, message: str, evidence: str, left: float) -> Diagnosis:
    remedy = "look at the worst state; the fault is in terms that the parts that agree do not use"
    return Diagnosis(deviation.function, "unknown", message, evidence, remedy, left, "unknown")


def unexplained(
    deviation: Deviation, search: Search, nothing: Explanation, found: Sequence[Explanation], evidence: str
) -> list[Diagnosis]:
    """The place of the deviation, and the explanation of a part of it."""
    before = nothing.by_part
    wrong = [part for part, size in before.items() if size > deviation.bound]
    diagnoses, explained = [], set()
    for part in wrong:
        mending = [x for x in found if x.by_part[part] <= deviation.bound and _no_worse(x, nothing, deviation.bound)]
        if not mending:
            continue
        explained.add(part)
        explanation, *others = sorted(map(search.without_idle_numbers, mending), key=preference)
        also = [said.message for x in others if x.size == explanation.size for said in x.said]
        left = float(np.abs(search.all_rows.residuals([explanation.code])).max())
        diagnoses += [
            diagnosis_of(deviation.function, said, f"explains {EXPERIMENT_PARTS[part]}; {evidence}", left, "part", also)
            for said in explanation.said
        ]
    rest = [part for part in wrong if part not in explained]
    if rest:
        where = " and ".join(EXPERIMENT_PARTS[part] for part in rest)
        message = f"no fault of the catalog explains the deviation {where}"
    elif wrong:
        message = "what the parts leave together has no explanation"
    else:
        message = (
            "gravity, mass matrix and velocity terms are right separately; only certain states or their sum deviate"
        )
    message += _where(deviation, search)
    return [*diagnoses, unknown(deviation, message, evidence, float(nothing.worst.max()))]


def _no_worse(explanation: Explanation, nothing: Explanation, bound: float) -> bool:
    after, before = explanation.by_part, nothing.by_part
    return all(after[part] <= max(bound, before[part] * (1 + 1e-9)) for part in after)


def _where(deviation: Deviation, search: Search) -> str:
    """The joints whose torques deviate, or the direction in which all deviate."""
    (residual,) = search.all_rows.residuals([search.own])
    torque = residual * search.all_rows.scale
    size = np.abs(residual).max(axis=0)
    names = [name for name, x in zip(deviation.trial.model.joint_names, size, strict=True) if x > deviation.bound]
    _, values, ways = np.linalg.svd(torque, full_matrices=False)
    if len(names) > 1 and values[1] <= deviation.bound * values[0]:
        way = ways[0] / ways[0][np.abs(ways[0]).argmax()]
        shown = ", ".join(
            f"{name} {x:.4g}" for name, x in zip(deviation.trial.model.joint_names, way, strict=True) if abs(x) > 1e-6
        )
        return f"; all deviations have one direction ({shown}), as from a constraint or a transmission"
    if 0 < len(names) < deviation.trial.model.n_bodies:
        return f"; only torques of {', '.join(names)} deviate"
    return ""


EQUIVALENT_FACTOR = 1.5
"""Factor on the least that an explanation leaves: those that leave no more are as good."""

ROUNDING_ERROR = 1e-12
"""What explanations leave below this is rounding of ours."""

MAX_EXTRA_NUMBERS = 1
"""Explanations that change so many numbers more are listed as alternatives."""


def diagnose(deviation: Deviation, say: Callable[[str], object]) -> Iterator[list[Diagnosis]]:
    """What is wrong with a function that deviates: first by one fault, nothing where there is none; then by two at
    once, or where the deviation is."""
    trial, observed = deviation.trial, deviation.observed
    own = split(torques(trial.model), trial, observed.acceleration)
    before = deviations(observed, own, scales(trial, own, observed))
    if not np.isfinite(list(before.values())).all():
        yield [unknown(deviation, "the answers are not finite", "", np.inf)]
        return
    experiments = of_experiments(trial, observed)
    catalog = Catalog.of_torques(trial.model, deviation.of_file())
    search = Search(trial.model, catalog, experiments, deviation.judged, deviation.noise, deviation.bound)
    nothing = search.nothing()
    evidence = evidence_of(deviation, before, observed, own)
    left = float((nothing.worst if deviation.judged is None else nothing.judged).max())
    if left <= deviation.bound and deviation.bound > deviation.tolerance:
        remedy = "judge it with a tolerance that its precision allows"
        yield [Diagnosis(deviation.function, "precision", precision_said(deviation.noise), evidence, remedy, left)]
        return
    if left <= deviation.bound and deviation.judged is None:
        yield []
        yield [unknown(deviation, "the experiments show no deviation: it is at other states", evidence, np.inf)]
        return
    found = search.alone(nothing)
    holding = holding_alone(search, found)
    vague = all(x.size >= LINK_PARAMETERS * trial.model.n_bodies for x in holding)  # any numbers of all bodies
    yield [] if vague else explained(deviation.function, search, holding, evidence)
    if nothing.experiments.max() > deviation.bound:
        say("looking for two faults at once")
        pairs = search.together(firsts(found, nothing, deviation.bound))
        holding = [pair for pair in pairs if search.holds(pair)] or holding
    if holding:
        yield explained(deviation.function, search, holding, evidence)
    else:
        yield unexplained(deviation, search, nothing, found, evidence)


def _told_plainly(holding: Sequence[Explanation]) -> bool:
    """Whether one of them is a mistake, or a few numbers."""
    return any(x.size <= SLIP_SIZE or not any(said.numbers for said in x.said) for x in holding)


def holding_alone(search: Search, found: Sequence[Explanation]) -> list[Explanation]:
    """What explains everything by one mistake: of those found, else other inertial parameters, else slips.

    Slips of other functions are few, and are always among them.
    """
    holding = [explanation for explanation in found if search.holds(explanation)]
    if not _told_plainly(holding) and search.has_right_equations:
        holding += [x for x in search.parameters() if search.holds(x)]
    if not _told_plainly(holding) or not search.is_of_torques:
        holding += [slip for slip in search.slips() if search.holds(slip)]
    return holding


def explained(function: str, search: Search, holding: Sequence[Explanation], evidence: str) -> list[Diagnosis]:
    """The smallest of the explanations that fit equally well, and the others."""
    least = min(explanation.left for explanation in holding)
    good = [x for x in holding if x.left <= max(EQUIVALENT_FACTOR * least, ROUNDING_ERROR, search.noise)]
    good = _distinct(sorted(good, key=preference))
    first, others = good[0], good[1:]
    alike = [x for x in others if x.size == first.size]
    listed = [x for x in others if x.size <= first.size + MAX_EXTRA_NUMBERS]
    one = all(
        same_code(first.code, x.code) or (x.kinds == first.kinds and same_everywhere(first, x, search)) for x in alike
    )
    status: DiagnosisStatus = "confirmed" if one else "candidate"
    also = ["; and ".join(said.message for said in x.said) for x in listed]
    apart = what_distinguishes(first, listed[:MAX_ALTERNATIVES], search) if listed else ""
    left = float(first.worst.max())
    return [
        diagnosis_of(function, said, evidence, left, status, also, apart)
        for said in sorted(first.said, key=lambda said: said.message)
    ]


def _distinct(explanations: Sequence[Explanation]) -> list[Explanation]:
    """The first of those with the same words, and none that says something more beside the words of another."""
    kept: list[tuple[frozenset[str], Explanation]] = []
    for explanation in explanations:
        words = frozenset(said.message for said in explanation.said)
        if not any(known <= words for known, _ in kept):
            kept.append((words, explanation))
    return [explanation for _, explanation in kept]


def merged(diagnoses: list[Diagnosis]) -> tuple[Diagnosis, ...]:
    """Each different diagnosis once, with the functions that it applies to."""
    by_message: dict[tuple[str, str], Diagnosis] = {}
    for diagnosis in diagnoses:
        known = by_message.setdefault((diagnosis.kind, diagnosis.message), diagnosis)
        if known is not diagnosis:
            function = f"{known.function}, {diagnosis.function}"
            by_message[diagnosis.kind, diagnosis.message] = replace(known, function=function)
    return tuple(by_message.values())
