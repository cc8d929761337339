"""From observations to diagnoses: which faults, put into graphdyn, give the numbers of a foreign function."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.judging.experiments import PARTS, Parts, TrialStates, deviations, scales, split, torques
from crosscheck.judging.faults.fault import KINDS
from crosscheck.judging.judgement import Diagnosis, Standing
from crosscheck.judging.observation import Observation, of_experiments
from crosscheck.judging.precision import precision_said
from crosscheck.judging.search import FIRSTS, Explanation, Search
from crosscheck.judging.telling_apart import same_code, same_everywhere, what_tells_apart
from graphdyn import RobotModel
from urdf._misreading import Misreadings

TIMES_NOISE = 10.0
"""A fault explains a deviation if it leaves at most this many times the noise of the function, at every state."""

AS_GOOD = 1.5
"""Factor on the least that an explanation leaves: those that leave no more are as good."""

ROUNDING = 1e-12
"""What explanations leave below this is rounding of ours."""

LISTED = 1
"""Explanations that change so many numbers more are listed as alternatives."""

MOST_ALTERNATIVES = 4


@dataclass(frozen=True, eq=False)
class Deviation:
    """A function that deviates, and what was seen of it.

    observed: the experiments
    judged: the answers at all judged states, None where no torques follow from them
    readings: gives the misreadings of the robot's file, None where it has none
    noise: relative, of the function; tolerance: relative error that counts as agreement
    """

    function: str
    model: RobotModel
    trial: TrialStates
    observed: Parts
    judged: Observation | None
    readings: Callable[[], Misreadings | None]
    noise: float
    tolerance: float

    @property
    def bound(self) -> float:
        return max(self.tolerance, TIMES_NOISE * self.noise)


def diagnose(deviation: Deviation, say: Callable[[str], object]) -> list[Diagnosis]:
    """What is wrong with a function that deviates."""
    model, trial, observed = deviation.model, deviation.trial, deviation.observed
    own = split(torques(model), trial, observed.acceleration)
    before = deviations(observed, own, scales(model, trial, own, observed))
    if not np.isfinite(list(before.values())).all():
        return [_unknown(deviation, "the answers are not finite", "", np.inf)]
    experiments = of_experiments(model, trial, observed)
    search = Search(model, deviation.readings(), experiments, deviation.judged, deviation.noise, deviation.bound)
    nothing = search.nothing()
    evidence = _evidence(deviation, before, observed, own)
    if nothing.worst.max() <= deviation.bound and deviation.bound > deviation.tolerance:
        remedy = "judge it with a tolerance that its precision allows"
        left = float(nothing.worst.max())
        return [Diagnosis(deviation.function, "precision", precision_said(deviation.noise), evidence, remedy, left)]
    found = search.alone(nothing)
    holding = [explanation for explanation in found if search.holds(explanation)]
    if not holding and nothing.experiments.max() > deviation.bound:
        say("looking for two faults at once")
        firsts = _firsts(found, nothing, deviation.bound)
        pairs = search.together(firsts)
        holding = [pair for pair in pairs if search.holds(pair)]
    if not holding:
        return _unexplained(deviation, search, nothing, found, evidence)
    return _explained(deviation, search, holding, evidence)


def _explained(deviation: Deviation, search: Search, holding: Sequence[Explanation], evidence: str) -> list[Diagnosis]:
    """The smallest of the explanations that fit equally well, and the others."""
    least = min(explanation.left for explanation in holding)
    good = [x for x in holding if x.left <= max(AS_GOOD * least, ROUNDING)]
    good = _distinct(sorted(good, key=_preference))
    first, others = good[0], good[1:]
    alike = [x for x in others if x.size == first.size]
    listed = [x for x in others if x.size <= first.size + LISTED]
    one = all(
        same_code(first.code, x.code) or (x.kinds == first.kinds and same_everywhere(first, x, search)) for x in alike
    )
    standing: Standing = "holds" if one else "candidate"
    also = tuple("; and ".join(said.message for said in x.said) for x in listed)[:MOST_ALTERNATIVES]
    apart = what_tells_apart(first, listed[:MOST_ALTERNATIVES], search) if listed else ""
    return [
        Diagnosis(
            deviation.function,
            said.kind,
            said.message,
            evidence,
            said.remedy,
            float(first.worst.max()),
            standing,
            also,
            apart,
            said.numbers,
        )
        for said in sorted(first.said, key=lambda said: said.message)
    ]


def _preference(explanation: Explanation) -> tuple[object, ...]:
    """Fewer numbers first; then by kind and words, which is a rule and not the order of trial."""
    return explanation.size, *((KINDS.index(said.kind), said.message) for said in explanation.said)


def _distinct(explanations: Sequence[Explanation]) -> list[Explanation]:
    """The first of those with the same words, and none that says something more beside the words of another."""
    kept: list[tuple[frozenset[str], Explanation]] = []
    for explanation in explanations:
        words = frozenset(said.message for said in explanation.said)
        if not any(known <= words for known, _ in kept):
            kept.append((words, explanation))
    return [explanation for _, explanation in kept]


def _firsts(found: Sequence[Explanation], nothing: Explanation, bound: float) -> list[Explanation]:
    """Explanations to which a second fault is added: those that mend whole terms, and those that leave least."""
    before = _by_part(nothing)
    wrong = {part for part, size in before.items() if size > bound}

    def mended(explanation: Explanation) -> int:
        after = _by_part(explanation)
        broken = sum(after[part] > bound for part in after if part not in wrong)
        return sum(after[part] <= bound for part in wrong) - broken

    by_terms = sorted((x for x in found if mended(x) > 0), key=lambda x: (-mended(x), x.size, x.left))
    chosen = [*_differing(by_terms)[: FIRSTS // 2], *_differing(found)[:FIRSTS]]
    return _differing(chosen)[:FIRSTS]


def _differing(explanations: Sequence[Explanation]) -> list[Explanation]:
    """Those that leave different numbers."""
    kept: list[Explanation] = []
    for explanation in explanations:
        if not any(abs(explanation.left - x.left) <= 1e-6 * x.left for x in kept):
            kept.append(explanation)
    return kept


def _by_part(explanation: Explanation) -> dict[str, float]:
    """The largest error in each experiment."""
    rows = explanation.experiments
    return {part: float(rows[explanation.parts == part].max()) for part in dict.fromkeys(explanation.parts)}


def _unexplained(
    deviation: Deviation, search: Search, nothing: Explanation, found: Sequence[Explanation], evidence: str
) -> list[Diagnosis]:
    """Where the deviation is, and the explanation of a part of it."""
    before = _by_part(nothing)
    wrong = [part for part, size in before.items() if size > deviation.bound]
    diagnoses, explained = [], set()
    for part in wrong:
        mending = [x for x in found if _by_part(x)[part] <= deviation.bound and _no_worse(x, nothing, deviation.bound)]
        if not mending:
            continue
        explained.add(part)
        explanation, *others = sorted(mending, key=_preference)
        also = [said.message for x in others if x.size == explanation.size for said in x.said]
        left = float(np.abs(search.all_rows.residuals([explanation.code])).max())
        diagnoses += [
            Diagnosis(
                deviation.function,
                said.kind,
                said.message,
                f"explains {PARTS[part]}; {evidence}",
                said.remedy,
                left,
                "part",
                tuple(also[:MOST_ALTERNATIVES]),
                numbers=said.numbers,
            )
            for said in explanation.said
        ]
    rest = [part for part in wrong if part not in explained]
    if rest:
        message = f"no fault of the catalogue explains the deviation {' and '.join(PARTS[part] for part in rest)}"
    elif wrong:
        message = "what the parts leave together has no explanation"
    else:
        message = (
            "gravity, mass matrix and velocity terms are right separately; only certain states or their sum deviate"
        )
    where = _where(deviation, search)
    return [*diagnoses, _unknown(deviation, message + where, evidence, float(nothing.worst.max()))]


def _no_worse(explanation: Explanation, nothing: Explanation, bound: float) -> bool:
    after, before = _by_part(explanation), _by_part(nothing)
    return all(after[part] <= max(bound, before[part] * (1 + 1e-9)) for part in after)


def _where(deviation: Deviation, search: Search) -> str:
    """The joints whose torques deviate, or the direction in which all deviate."""
    (residual,) = search.all_rows.residuals([search.own])
    torque = residual * search.all_rows.scale
    size = np.abs(residual).max(axis=0)
    names = [name for name, x in zip(deviation.model.joint_names, size, strict=True) if x > deviation.bound]
    _, values, ways = np.linalg.svd(torque, full_matrices=False)
    if len(names) > 1 and values[1] <= deviation.bound * values[0]:
        way = ways[0] / ways[0][np.abs(ways[0]).argmax()]
        shown = ", ".join(
            f"{name} {x:.4g}" for name, x in zip(deviation.model.joint_names, way, strict=True) if abs(x) > 1e-6
        )
        return f"; all deviations have one direction ({shown}), as from a constraint or a transmission"
    if 0 < len(names) < deviation.model.n_bodies:
        return f"; only torques of {', '.join(names)} deviate"
    return ""


def _unknown(deviation: Deviation, message: str, evidence: str, left: float) -> Diagnosis:
    remedy = "look at the worst state; the fault is in terms that the parts that agree do not use"
    return Diagnosis(deviation.function, "unknown", message, evidence, remedy, left, "unknown")


def _evidence(deviation: Deviation, before: Mapping[str, float], observed: Parts, own: Parts) -> str:
    said = [
        f"{PARTS[part]}: {'agrees' if error <= deviation.bound else f'relative error {error:.1e}'}"
        for part, error in before.items()
    ]
    if "velocity" in before and before["velocity"] > deviation.bound:
        assert observed.doubled is not None
        assert own.doubled is not None
        assert observed.velocity is not None
        assert own.velocity is not None
        once = np.abs(observed.velocity - own.velocity).max()
        twice = np.abs(observed.doubled - own.doubled).max()
        said.append(f"at twice the velocity the error is {twice / once:.3g} times as large")
    if deviation.noise > deviation.tolerance / TIMES_NOISE:
        said.append(precision_said(deviation.noise))
    return "; ".join(said)


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
