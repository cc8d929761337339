"""Diagnoses from observations: which faults, put into graphdyn, give the numbers of a function under test."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from crosscheck.judging.judgment import Diagnosis, DiagnosisStatus
from crosscheck.judging.observing.deviation import Deviation, evidence_of
from crosscheck.judging.observing.observation import of_experiments
from crosscheck.judging.observing.precision import precision_said
from crosscheck.judging.searching.distinguishing import same_code, same_everywhere, what_distinguishes
from crosscheck.judging.searching.search import Explanation, Search, firsts, preference
from crosscheck.judging.searching.unexplained import MAX_ALTERNATIVES, unexplained, unknown
from crosscheck.judging.states.experiments import deviations, scales, split, torques

EQUIVALENT_FACTOR = 1.5
"""Factor on the least that an explanation leaves: those that leave no more are as good."""

ROUNDING_ERROR = 1e-12
"""What explanations leave below this is rounding of ours."""

MAX_EXTRA_NUMBERS = 1
"""Explanations that change so many numbers more are listed as alternatives."""


def diagnose(deviation: Deviation, say: Callable[[str], object]) -> list[Diagnosis]:
    """What is wrong with a function that deviates."""
    model, trial, observed = deviation.model, deviation.trial, deviation.observed
    own = split(torques(model), trial, observed.acceleration)
    before = deviations(observed, own, scales(model, trial, own, observed))
    if not np.isfinite(list(before.values())).all():
        return [unknown(deviation, "the answers are not finite", "", np.inf)]
    experiments = of_experiments(model, trial, observed)
    search = Search(model, deviation.readings(), experiments, deviation.judged, deviation.noise, deviation.bound)
    nothing = search.nothing()
    evidence = evidence_of(deviation, before, observed, own)
    left = float((nothing.worst if deviation.judged is None else nothing.judged).max())
    if left <= deviation.bound and deviation.bound > deviation.tolerance:
        remedy = "judge it with a tolerance that its precision allows"
        return [Diagnosis(deviation.function, "precision", precision_said(deviation.noise), evidence, remedy, left)]
    found = search.alone(nothing)
    holding = [explanation for explanation in found if search.holds(explanation)]
    if not holding and nothing.experiments.max() > deviation.bound:
        say("looking for two faults at once")
        pairs = search.together(firsts(found, nothing, deviation.bound))
        holding = [pair for pair in pairs if search.holds(pair)]
    if not holding:
        return unexplained(deviation, search, nothing, found, evidence)
    return _explained(deviation, search, holding, evidence)


def _explained(deviation: Deviation, search: Search, holding: Sequence[Explanation], evidence: str) -> list[Diagnosis]:
    """The smallest of the explanations that fit equally well, and the others."""
    least = min(explanation.left for explanation in holding)
    good = [x for x in holding if x.left <= max(EQUIVALENT_FACTOR * least, ROUNDING_ERROR)]
    good = _distinct(sorted(good, key=preference))
    first, others = good[0], good[1:]
    alike = [x for x in others if x.size == first.size]
    listed = [x for x in others if x.size <= first.size + MAX_EXTRA_NUMBERS]
    one = all(
        same_code(first.code, x.code) or (x.kinds == first.kinds and same_everywhere(first, x, search)) for x in alike
    )
    status: DiagnosisStatus = "confirmed" if one else "candidate"
    also = tuple("; and ".join(said.message for said in x.said) for x in listed)[:MAX_ALTERNATIVES]
    apart = what_distinguishes(first, listed[:MAX_ALTERNATIVES], search) if listed else ""
    return [
        Diagnosis(
            deviation.function,
            said.kind,
            said.message,
            evidence,
            said.remedy,
            float(first.worst.max()),
            status,
            also,
            apart,
            said.numbers,
        )
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
        key = diagnosis.kind, diagnosis.message
        known = by_message.get(key)
        by_message[key] = (
            diagnosis if known is None else replace(known, function=f"{known.function}, {diagnosis.function}")
        )
    return tuple(by_message.values())
