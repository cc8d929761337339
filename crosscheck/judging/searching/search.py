"""The search for what explains an observation: every fault, every family, then two of them together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.catalog import families, faults, limits, smooth_friction
from crosscheck.judging.faults.fault import FAULT_KINDS, CodeFault, Family, FaultDescription
from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.judging.observing.observation import Observation
from crosscheck.judging.searching.fitting import fitted, root_mean_square, sparse
from graphdyn import RobotModel
from graphdyn.layout import Array

TRIAL_STATES = 2
"""Number of states of the experiments with which all faults are tried; the first, and one with whole turns added."""

FITTING_STATES = 3
"""Number of states of the experiments with which families are fitted."""

MAX_KEPT_FAULTS = 150
"""Number of faults, those that leave least at these states, that are tried at the others."""

N_FIRST_FAULTS = 5
"""Number of explanations that leave a part to which a second fault is added."""

N_SECOND_FAULTS = 12
"""Number of second faults that are fitted together with the first."""


@dataclass(frozen=True, eq=False)
class Explanation:
    """Faults put into graphdyn, and what they leave.

    elements: each with its numbers, none for a fault without
    left: root mean square over the experiments; worst: (T,) the largest entry of each row, of the experiments alone
        unless they are explained; parts: of the rows of the experiments
    """

    elements: tuple[tuple[CodeFault | Family, Array], ...]
    code: DynamicsCode
    left: float
    worst: Array
    parts: NDArray[np.str_]

    @property
    def said_by_element(self) -> list[list[FaultDescription]]:
        return [[x.said] if isinstance(x, CodeFault) else x.say(numbers) for x, numbers in self.elements]

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


class Search:
    """Over one robot, one observation.

    of_file: faults in reading the robot's file
    tried: the rows of the experiments; all_rows: those and the judged states; noise, bound: relative
    """

    def __init__(
        self,
        model: RobotModel,
        of_file: Sequence[CodeFault],
        experiments: Observation,
        judged: Observation | None,
        noise: float,
        bound: float,
    ) -> None:
        self.model, self.noise, self.bound = model, noise, bound
        self.experiments, self.judged = experiments, judged
        self.all_rows = experiments if judged is None else experiments.and_(judged)
        self.own = DynamicsCode.of(model)
        self._faults, self._families = [*faults(model), *of_file], list(families(model))
        self._tried, self._fitted = (
            experiments.only(_of_states(experiments, size)) for size in (TRIAL_STATES, FITTING_STATES)
        )

    def alone(self, base: Explanation) -> list[Explanation]:
        """Every explanation with one fault more, those that leave least first."""
        known = [*self._faults, *self._from_answers(base)]
        left = root_mean_square(self._tried.residuals([fault.change(base.code) for fault in known]))
        kept = [known[k] for k in np.argsort(left, kind="stable")[:MAX_KEPT_FAULTS]]
        found = [self._explanation(base, [(fault, np.zeros(0)) for fault in kept])]
        fits = fitted(self._families, base.code, self._fitted, self.noise)
        best = sorted(fits, key=lambda fit: fit.left)[:MAX_KEPT_FAULTS]
        best = [sparse(fit, base.code, self.experiments, self.noise, self.bound) for fit in best]
        found.append(self._explanation(base, [(fit.family, fit.numbers) for fit in best]))
        return sorted((x for group in found for x in group if x.is_told), key=lambda x: x.left)

    def together(self, started: Sequence[Explanation]) -> list[Explanation]:
        """Explanations with a second fault added to each of these, the numbers of both fitted together.

        Once a pair holds, those that cannot be as small are left out.
        """
        found: list[Explanation] = []
        smallest = np.inf
        for first in sorted(started, key=lambda x: x.size):
            if first.size + 1 > smallest:
                break
            found += [self._refitted(second) for second in self.alone(first)[:N_SECOND_FAULTS]]
            smallest = min((x.size for x in found if self.holds(x)), default=np.inf)
        return found

    def nothing(self) -> Explanation:
        """The code without fault."""
        (explanation,) = self._explanation(
            Explanation((), self.own, np.inf, np.zeros(0), self.experiments.part), [None]
        )
        return explanation

    def _refitted(self, explanation: Explanation) -> Explanation:
        """The fault with the numbers of all its families fitted at once."""
        elements = explanation.elements
        if not any(isinstance(element, Family) for element, _ in elements):
            return explanation
        lengths = [len(x) for _, x in elements]
        ends = np.cumsum(lengths)

        def changed(code: DynamicsCode, x: Array) -> DynamicsCode:
            for (element, _), end, length in zip(elements, ends, lengths, strict=True):
                code = (
                    element.change(code)
                    if isinstance(element, CodeFault)
                    else element.change(code, x[end - length : end])
                )
            return code

        start = np.concatenate([x for _, x in elements])
        right = np.concatenate([np.zeros(0) if isinstance(x, CodeFault) else x.right for x, _ in elements])
        joint = Family(right, changed, lambda x: [], start[None])
        (fit,) = fitted([joint], self.own, self.experiments, self.noise)
        fit = sparse(fit, self.own, self.experiments, self.noise, self.bound)
        numbers = np.split(fit.numbers, ends[:-1])
        pairs = [(element, x) for (element, _), x in zip(elements, numbers, strict=True)]
        return self._whole(tuple(pairs), changed(self.own, fit.numbers))

    def _explanation(
        self, base: Explanation, added: Sequence[tuple[CodeFault | Family, Array] | None]
    ) -> list[Explanation]:
        """The base with each of these added; tried at the judged states only if it fits the experiments."""
        codes = [_changed(base.code, element) for element in added]
        if not codes:
            return []
        residuals = self.experiments.residuals(codes)
        with np.errstate(invalid="ignore"):
            worst = np.nan_to_num(np.abs(residuals).max(axis=2), nan=np.inf)
        left = root_mean_square(residuals)
        found = []
        for element, code, size, rows in zip(added, codes, left, worst, strict=True):
            elements = base.elements if element is None else (*base.elements, element)
            explanation = Explanation(elements, code, float(size), rows, self.experiments.part)
            fits = element is None or rows.max() <= self.bound
            found.append(self._whole(elements, code) if fits else explanation)
        return found

    def _whole(self, elements: tuple[tuple[CodeFault | Family, Array], ...], code: DynamicsCode) -> Explanation:
        residuals = self.all_rows.residuals([code])
        with np.errstate(invalid="ignore"):
            worst = np.nan_to_num(np.abs(residuals[0]).max(axis=1), nan=np.inf)
        return Explanation(elements, code, float(root_mean_square(residuals)[0]), worst, self.experiments.part)

    def holds(self, explanation: Explanation) -> bool:
        """Whether it leaves no more than the bound, at the judged states too, and all of it has words."""
        everywhere = len(explanation.worst) == len(self.all_rows.part)
        return everywhere and explanation.is_told and bool(explanation.worst.max() <= self.bound)

    def _from_answers(self, base: Explanation) -> list[CodeFault]:
        judged = self.judged
        if judged is None or (judged.less >= 0).any():
            return []
        found = list(limits(self.model, np.concatenate([self.experiments.torques(), judged.torques()])))
        only_moving = base.experiments[base.parts != "velocity"].max(initial=0.0) <= self.bound
        if only_moving and base.worst.max() > self.bound:
            deviation = -judged.residuals([base.code])[0] * judged.scale
            bound = self.bound * float(judged.scale.max())
            found += smooth_friction(self.model, judged.state[1], deviation, bound)
        return found


def preference(explanation: Explanation) -> tuple[object, ...]:
    """Fewer numbers first; then by kind and words, which is a rule and not the order of trial."""
    return explanation.size, *((FAULT_KINDS.index(said.kind), said.message) for said in explanation.said)


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


def _changed(code: DynamicsCode, element: tuple[CodeFault | Family, Array] | None) -> DynamicsCode:
    if element is None:
        return code
    fault, numbers = element
    return fault.change(code) if isinstance(fault, CodeFault) else fault.change(code, numbers)


def _of_states(experiments: Observation, number: int) -> NDArray[np.bool_]:
    """Rows of the first and the last states."""
    _, first, of = np.unique(experiments.state[0][experiments.of], axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return np.isin(of.ravel(), [*order[: (number + 1) // 2], *order[len(order) - number // 2 :]])
