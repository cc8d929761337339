"""Explanations of an observation: faults put into graphdyn, what they leave, and which are preferred."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import FAULT_KINDS, CodeFault, FaultDescription
from crosscheck.judging.faults.recursion import DynamicsCode
from graphdyn.layout import Array

N_FIRST_FAULTS = 5
"""Number of explanations that leave a part to which a second fault is added."""

Element = tuple[CodeFault, Array]
"""A fault with its numbers (p,)."""


@dataclass(frozen=True, eq=False)
class Explanation:
    """Faults put into graphdyn, and what they leave.

    left: root mean square over the experiments; worst: (T,) the largest entry of each row, of the experiments alone
        unless they are explained; parts: of the rows of the experiments
    """

    elements: tuple[Element, ...]
    code: DynamicsCode
    left: float
    worst: Array
    parts: NDArray[np.str_]

    @property
    def said_by_element(self) -> list[list[FaultDescription]]:
        return [list(fault.say(numbers)) for fault, numbers in self.elements]

    @property
    def said(self) -> list[FaultDescription]:
        return [said for element in self.said_by_element for said in element]

    @property
    def is_told(self) -> bool:
        """Whether each element says something: a family whose numbers are right is no fault."""
        return bool(self.elements) and all(self.said_by_element)

    @property
    def experiments(self) -> Array:
        """The largest entry of each row of the experiments."""
        return self.worst[: len(self.parts)]

    @property
    def judged(self) -> Array:
        """The largest entry of each row of the judged states."""
        return self.worst[len(self.parts) :]

    @property
    def by_part(self) -> dict[str, float]:
        """The largest error in each experiment."""
        return {part: float(self.experiments[self.parts == part].max()) for part in dict.fromkeys(self.parts)}

    @property
    def kinds(self) -> set[str]:
        return {said.kind for said in self.said}

    @property
    def size(self) -> int:
        return sum(said.size for said in self.said)


def preference(explanation: Explanation) -> tuple[object, ...]:
    """Fewer numbers first, mistakes before fitted numbers; then by kind and words: a rule, not the order of trial."""
    said = explanation.said
    has_numbers = any(one.numbers and one.kind != "gravity" for one in said)
    return explanation.size, has_numbers, *((FAULT_KINDS.index(one.kind), one.message) for one in said)


def firsts(found: Sequence[Explanation], nothing: Explanation, bound: float) -> list[Explanation]:
    """Explanations to which a second fault is added: those that mend whole terms, and those that leave least."""
    before = nothing.by_part
    wrong = {part for part, size in before.items() if size > bound}

    def mended(explanation: Explanation) -> int:
        after = explanation.by_part
        broken = sum(after[part] > bound for part in after if part not in wrong)
        return sum(after[part] <= bound for part in wrong) - broken

    by_terms = sorted((x for x in found if mended(x) > 0), key=lambda x: (-mended(x), x.size, x.left))
    chosen = [*_differing(by_terms)[: N_FIRST_FAULTS // 2], *_differing(found)[:N_FIRST_FAULTS]]
    return _differing(chosen)[:N_FIRST_FAULTS]


def _differing(explanations: Sequence[Explanation]) -> list[Explanation]:
    """Explanations that leave different numbers."""
    kept: list[Explanation] = []
    for explanation in explanations:
        if not any(abs(explanation.left - x.left) <= 1e-6 * x.left for x in kept):
            kept.append(explanation)
    return kept
