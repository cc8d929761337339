"""Diagnoses of deviations that nothing explains as a whole: their parts, and where they are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.judging.judgment import Diagnosis
from crosscheck.judging.observing.deviation import Deviation
from crosscheck.judging.searching.search import Explanation, Search, preference
from crosscheck.judging.states.experiments import EXPERIMENT_PARTS

MAX_ALTERNATIVES = 4


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
        explanation, *others = sorted(mending, key=preference)
        also = [said.message for x in others if x.size == explanation.size for said in x.said]
        left = float(np.abs(search.all_rows.residuals([explanation.code])).max())
        diagnoses += [
            Diagnosis(
                deviation.function,
                said.kind,
                said.message,
                f"explains {EXPERIMENT_PARTS[part]}; {evidence}",
                said.remedy,
                left,
                "part",
                tuple(also[:MAX_ALTERNATIVES]),
                numbers=said.numbers,
            )
            for said in explanation.said
        ]
    rest = [part for part in wrong if part not in explained]
    if rest:
        message = (
            f"no fault of the catalog explains the deviation {' and '.join(EXPERIMENT_PARTS[part] for part in rest)}"
        )
    elif wrong:
        message = "what the parts leave together has no explanation"
    else:
        message = (
            "gravity, mass matrix and velocity terms are right separately; only certain states or their sum deviate"
        )
    where = _where(deviation, search)
    return [*diagnoses, unknown(deviation, message + where, evidence, float(nothing.worst.max()))]


def _no_worse(explanation: Explanation, nothing: Explanation, bound: float) -> bool:
    after, before = explanation.by_part, nothing.by_part
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
