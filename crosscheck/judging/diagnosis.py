"""From experiments to diagnoses: which fault, put into graphdyn, gives the numbers of a foreign function."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain

import numpy as np

from crosscheck.judging.experiments import PARTS, Parts, TrialStates, deviations, scales, split, torques
from crosscheck.judging.faults.all_faults import faults
from crosscheck.judging.faults.fault import Fault
from crosscheck.judging.fits import (
    FittedFault,
    ParameterFits,
    friction,
    gravity_vector,
    rotor_inertia,
    velocity_factors,
)
from crosscheck.judging.judgement import Diagnosis
from crosscheck.judging.orders import order_faults
from graphdyn import RobotModel
from graphdyn.layout import Array

NOISE = 1e-9
"""Relative deviation below which a part agrees: experiments are differences of torques, which lose some digits."""

EXPLAINED = 1e-5
"""Part of a deviation that a fault may leave and still explain it: foreign codes round their constants."""

AS_GOOD = 30.0
"""Factor on what the best explanation leaves: explanations that leave no more are as good."""

SMALL = 1e-4
"""Relative deviation below which one without an explanation is a lack of precision."""

MOST_ALTERNATIVES = 4


def diagnose(
    function: str, observed: Parts, model: RobotModel, trial: TrialStates, links: Mapping[str, tuple[int, Array]]
) -> list[Diagnosis]:
    """What is wrong, from the experiments on one function; empty if all of them agree."""
    own = split(torques(model), trial)
    scale = scales(model, trial, own, observed)
    before = deviations(observed, own, scale)
    wrong = [part for part, error in before.items() if error > NOISE]
    if not wrong:
        return []
    evidence = _evidence(before, observed, own)
    if not np.isfinite(list(before.values())).all():
        return [_unknown(function, "the answers are not finite", evidence)]

    def explained(findings: Iterator[FittedFault], size: float) -> list[FittedFault]:
        good = [found for found in findings if found.left <= _bound(size)]
        least = min((found.left for found in good), default=0.0)
        return [found for found in good if found.left <= max(NOISE, AS_GOOD * least)]

    by_part = {part: explained(_of_part(part, model, trial, observed, own, scale), before[part]) for part in wrong}
    if len(wrong) == 1 and by_part[wrong[0]]:
        return [_diagnosis(function, by_part[wrong[0]], evidence)]
    fits, size = ParameterFits(model, trial, _difference(observed, own), scale), max(before.values())
    of_all = _of_all(model, trial, observed, scale, links, _bound(size))
    if together := explained(chain(of_all, fits.named()), size):
        return [_diagnosis(function, together, evidence)]
    if all(by_part.values()):
        return [_diagnosis(function, found, evidence) for found in by_part.values()]
    if other := explained(fits.unnamed(), size):
        return [_diagnosis(function, other[:1], evidence)]
    found = [_diagnosis(function, findings, evidence) for findings in by_part.values() if findings]
    rest = [part for part in wrong if not by_part[part]]
    if max(before[part] for part in rest) < SMALL:
        message = (
            f"the answers agree to {-np.log10(max(before.values())):.0f} digits: single precision, or rounded constants"
        )
    else:
        message = f"no single fault explains the deviation {' and '.join(PARTS[part] for part in rest)}"
    return [*found, _unknown(function, message, evidence)]


def _bound(size: float) -> float:
    """Largest error that an explanation of a deviation of this size may leave."""
    return max(NOISE, EXPLAINED * size)


def _of_part(
    part: str, model: RobotModel, trial: TrialStates, observed: Parts, own: Parts, scale: dict[str, float]
) -> Iterator[FittedFault]:
    """Faults with free numbers that affect only this part."""
    if part == "gravity":
        yield gravity_vector(model, trial, observed, scale)
    elif part == "velocity":
        yield velocity_factors(model, trial, observed, scale)
        assert observed.velocity is not None
        assert own.velocity is not None
        yield friction(trial, observed.velocity - own.velocity, scale[part])
    else:
        assert observed.inertia is not None
        assert own.inertia is not None
        yield rotor_inertia(observed.inertia - own.inertia, scale[part])


def _of_all(
    model: RobotModel,
    trial: TrialStates,
    observed: Parts,
    scale: dict[str, float],
    links: Mapping[str, tuple[int, Array]],
    bound: float,
) -> Iterator[FittedFault]:
    """Faults that affect several parts at once, the likelier first; without those that leave more than bound at the
    first state."""
    first = TrialStates(trial.q[:1], trial.v[:1])
    observed_there = observed.first()
    answer = None
    if observed.gravity is not None and observed.velocity is not None:
        answer = observed.gravity[0] + observed.velocity[0]
    columns = None if observed.inertia is None else np.swapaxes(observed.inertia[0], -1, -2)
    for fault in (*faults(model, links), *order_faults(model, trial.q[0], trial.v[0], answer, columns)):
        if _left(observed_there, fault, first, scale) <= bound:
            yield FittedFault(fault.kind, fault.message, fault.remedy, _left(observed, fault, trial, scale))


def _left(observed: Parts, fault: Fault, trial: TrialStates, scale: dict[str, float]) -> float:
    return max(deviations(observed, split(fault.torque, trial), scale).values())


def _difference(x: Parts, y: Parts) -> Parts:
    return Parts(*(getattr(x, part) - getattr(y, part) if part in x.known() else None for part in PARTS))


def _diagnosis(function: str, findings: list[FittedFault], evidence: str) -> Diagnosis:
    first, *others = findings
    also = tuple(dict.fromkeys(other.message for other in others if other.message != first.message))
    return Diagnosis(function, first.kind, first.message, evidence, first.remedy, first.left, also[:MOST_ALTERNATIVES])


def _unknown(function: str, message: str, evidence: str) -> Diagnosis:
    remedy = "look at the worst state; the fault is in terms that the parts that agree do not use"
    return Diagnosis(function, "unknown", message, evidence, remedy, np.inf)


def _evidence(before: Mapping[str, float], observed: Parts, own: Parts) -> str:
    said = [
        f"{PARTS[part]}: {'agrees' if error <= NOISE else f'relative error {error:.1e}'}"
        for part, error in before.items()
    ]
    if "velocity" in before and before["velocity"] > NOISE:
        assert observed.doubled is not None
        assert own.doubled is not None
        assert observed.velocity is not None
        assert own.velocity is not None
        once = np.abs(observed.velocity - own.velocity).max()
        twice = np.abs(observed.doubled - own.doubled).max()
        said.append(f"at twice the velocity the error is {twice / once:.3g} times as large")
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
