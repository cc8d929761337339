"""The search for what explains an observation: every fault, every family, then two of them together."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.catalog import families, faults, limits, smooth_friction
from crosscheck.judging.faults.fault import COMPLEX_STEP, NO_NUMBERS, CodeFault
from crosscheck.judging.faults.file_reading import FileFaults
from crosscheck.judging.faults.inertials import PARAMETER_SETS, of_body
from crosscheck.judging.faults.link_parameters import PlacedInertial
from crosscheck.judging.faults.recursion import DynamicsCode, torques_of
from crosscheck.judging.functions.projected import projected
from crosscheck.judging.observing.observation import Observation
from crosscheck.judging.searching.explanation import Element, Explanation
from crosscheck.judging.searching.fitting import effects, fitted, root_mean_square, sparse
from crosscheck.judging.searching.parameters import OtherParameters
from crosscheck.judging.slips.operations import Formulation
from crosscheck.judging.slips.search import TORQUE_FORMULATIONS, fitting_slips
from graphdyn import RobotModel
from graphdyn.layout import Array

log = logging.getLogger(__name__)

TRIAL_STATES = 2
"""Number of states of the experiments with which all faults are tried; the first, and one with whole turns added."""

FITTING_STATES = 3
"""Number of states of the experiments with which families are fitted."""

MIN_FITTED_ANSWERS = 15
"""Number of answers to which families are fitted at least: those of one body have ten numbers."""

MANY_ANSWERS = 30
"""Number of answers at one state from which on one state is enough to try and to fit."""

MAX_KEPT_FAULTS = 150
"""Number of faults, those that leave least at these states, that are tried at the others."""

N_SECOND_FAULTS = 12
"""Number of second faults that are fitted together with the first."""


@dataclass(frozen=True, eq=False)
class Catalog:
    """What may be wrong with a function.

    own: the code without fault; faults, families: that are tried; links: as the file has them
    formulations: whose operations are open to slips
    is_linear: whether the answers are linear in the inertial parameters
    known: torques of all its faults or slips at the states of a search, for the next one
    """

    own: DynamicsCode
    faults: Sequence[CodeFault]
    families: Sequence[CodeFault]
    links: Sequence[PlacedInertial]
    formulations: Sequence[Formulation]
    is_linear: bool
    known: dict[object, Array] = field(default_factory=dict)

    @classmethod
    def of_torques(cls, model: RobotModel, of_file: FileFaults) -> Catalog:
        known = [*faults(model), *of_file.faults]
        own = DynamicsCode.of(model)
        return cls(own, known, list(families(model)), of_file.links, (*TORQUE_FORMULATIONS, projected), is_linear=True)


class Search:
    """Over one robot, one observation.

    tried: the rows of the experiments; all_rows: those and the judged states; noise, bound: relative
    """

    def __init__(
        self,
        model: RobotModel,
        catalog: Catalog,
        experiments: Observation,
        judged: Observation | None,
        noise: float,
        bound: float,
    ) -> None:
        self.model, self._catalog, self.noise, self.bound = model, catalog, noise, bound
        self.experiments, self.judged = experiments, judged
        self.all_rows = experiments if judged is None else experiments.and_(judged)
        self.own = catalog.own
        width = experiments.answers.shape[1]
        tried, fitting = TRIAL_STATES, max(FITTING_STATES, -(-MIN_FITTED_ANSWERS // width))
        if width >= MANY_ANSWERS:
            tried, fitting = 1, 1
        self._tried, self._fitted = (experiments.only(_of_states(experiments, size)) for size in (tried, fitting))

    def alone(self, base: Explanation) -> list[Explanation]:
        """Every explanation with one fault more, those that leave least first."""
        known = [*self._catalog.faults, *(self._from_answers(base) if self.is_of_torques else ())]
        log.info("trying %d faults", len(known))
        if base.elements or len(known) > len(self._catalog.faults):
            residuals = self._tried.residuals([fault.change(base.code, NO_NUMBERS) for fault in known])
        else:
            residuals = self._of_faults()
        left = root_mean_square(residuals)
        kept = [known[k] for k in np.argsort(left, kind="stable")[:MAX_KEPT_FAULTS]]
        log.info("fitting %d families of faults", len(self._catalog.families))
        fits = fitted(self._catalog.families, base.code, self._fitted, self.noise)
        log.info("measuring what is left")
        best = sorted(fits, key=lambda fit: fit.left)[:MAX_KEPT_FAULTS]
        best = [sparse(fit, base.code, self.experiments, self.noise, self.bound) for fit in best]
        added = [*((fault, NO_NUMBERS) for fault in kept), *((fit.family, fit.numbers) for fit in best)]
        found = self._measured([((*base.elements, x), x[0].change(base.code, x[1])) for x in added], self.experiments)
        fitting = [x for x in found if x.worst.max() <= self.bound]
        everywhere = iter(self._measured([(x.elements, x.code) for x in fitting], self.all_rows))
        found = [next(everywhere) if x in fitting else x for x in found]
        return sorted((x for x in found if x.is_told), key=lambda x: x.left)

    @property
    def has_right_equations(self) -> bool:
        """Whether some inertial parameters give all answers."""
        return self._catalog.is_linear and self.other_parameters.fits

    @cached_property
    def other_parameters(self) -> OtherParameters:
        """What the answers say of the inertial parameters."""
        return OtherParameters(self.own, self.experiments, self.bound)

    def parameters(self) -> list[Explanation]:
        """Mistakes in the inertial parameters of links that give the answers; else numbers of a few bodies."""
        known = list(self.other_parameters.faults(self._catalog.links))
        found = self._measured([(((x, NO_NUMBERS),), x.change(self.own, NO_NUMBERS)) for x in known], self.all_rows)
        if any(map(self.holds, found)):
            return found
        for bodies in self.other_parameters.of_bodies():
            if (fitted_numbers := self._numbers_of(bodies)) is not None:
                found.append(fitted_numbers)
        if not found and (rest := self.other_parameters.smallest()) is not None:
            found = self._measured([(((rest, NO_NUMBERS),), rest.change(self.own, NO_NUMBERS))], self.all_rows)
        return found

    def _numbers_of(self, bodies: Sequence[int]) -> Explanation | None:
        """The fewest numbers of these bodies that give the answers: a mass, a center, a tensor of each, and so on."""
        choices = sorted(product(PARAMETER_SETS, repeat=len(bodies)), key=lambda x: sum(map(len, x)))
        for places in choices:
            families = [of_body(self.model, body, which) for body, which in zip(bodies, places, strict=True)]
            elements = tuple((family, family.right) for family in families)
            (found,) = self._refitted(self._measured([(elements, self.own)], self.experiments))
            if self.holds(found):
                return found
        return None

    def looks_explained(self) -> bool:
        """Whether one fault without numbers, another gravity or one slip gives the first answers: a quick look."""
        left = root_mean_square(self._of_faults())
        if left.min(initial=np.inf) <= self.bound or self._slips(self.experiments):
            return True
        gravity = fitted(self._catalog.families[:1], self.own, self._fitted, self.noise)
        return any(fit.left <= self.bound for fit in gravity)

    def _of_faults(self) -> Array:
        """What each fault without numbers leaves of the first answers (K, T, n)."""
        known, key = self._catalog.known, self._tried.state_key
        if key not in known:
            codes = [fault.change(self.own, NO_NUMBERS) for fault in self._catalog.faults]
            known[key] = torques_of(codes, self._tried.state)
        return self._tried.left_by(known[key])

    @property
    def is_of_torques(self) -> bool:
        """Whether the answers are torques, or can be read as such."""
        return self.own.recursion is None

    def slips(self) -> list[Explanation]:
        """Every slip of the formulations that people write that gives the numbers of the first rows."""
        log.info("looking for slips in %d formulations", len(self._catalog.formulations))
        slips = self._slips(self.all_rows)
        return self._measured([(((x, NO_NUMBERS),), x.change(self.own, NO_NUMBERS)) for x in slips], self.all_rows)

    def _slips(self, rows: Observation) -> list[CodeFault]:
        names = self.model.joint_names, self.model.body_names
        return list(fitting_slips(self._catalog.formulations, self.own, names, rows, self.bound, self._catalog.known))

    def together(self, started: Sequence[Explanation]) -> list[Explanation]:
        """Explanations with a second fault added to each of these, the numbers of both fitted together.

        Once a pair holds, those that cannot be as small are left out.
        """
        found: list[Explanation] = []
        smallest = np.inf
        for number, first in enumerate(sorted(started, key=lambda x: x.size), start=1):
            log.info("a second fault beside %d of %d", number, len(started))
            if first.size + 1 > smallest:
                break
            found += self._refitted(self.alone(first)[:N_SECOND_FAULTS])
            smallest = min((x.size for x in found if self.holds(x)), default=np.inf)
        return found

    def without_idle_numbers(self, explanation: Explanation) -> Explanation:
        """One fault with those of its numbers put right whose effects are below the bound: rounding of a fit to what it
        does not explain. The same where it would explain fewer parts."""
        ((fault, numbers),) = explanation.elements
        if not len(numbers):
            return explanation
        idle = effects(fault, numbers, self.own, self.experiments) <= self.bound
        fewer = np.where(idle, fault.right, numbers)
        (found,) = self._measured([(((fault, fewer),), fault.change(self.own, fewer))], self.experiments)
        broken = any(found.by_part[part] > self.bound >= size for part, size in explanation.by_part.items())
        return explanation if broken else found

    def nothing(self) -> Explanation:
        """The code without fault."""
        (explanation,) = self._measured([((), self.own)], self.all_rows)
        return explanation

    def _refitted(self, explanations: Sequence[Explanation]) -> list[Explanation]:
        """Each with the numbers of all its families fitted at once."""
        fitting = [x for x in explanations if any(len(numbers) for _, numbers in x.elements)]
        if untried := [x for x in fitting if not _takes_steps(x.elements, self.own)]:
            return self._refitted([x for x in explanations if x not in untried])
        if not fitting:
            return list(explanations)
        fits = fitted([_joint(x.elements) for x in fitting], self.own, self.experiments, self.noise)
        fits = [sparse(fit, self.own, self.experiments, self.noise, self.bound) for fit in fits]
        codes = [
            (_with_numbers(x.elements, fit.numbers), fit.family.change(self.own, fit.numbers))
            for x, fit in zip(fitting, fits, strict=True)
        ]
        refitted = iter(self._measured(codes, self.all_rows))
        return [next(refitted) if x in fitting else x for x in explanations]

    def _measured(
        self, codes: Sequence[tuple[tuple[Element, ...], DynamicsCode]], rows: Observation
    ) -> list[Explanation]:
        """Explanations by their faults, and by the code that has them, tried at these rows."""
        if not codes:
            return []
        residuals = rows.residuals([code for _, code in codes])
        with np.errstate(invalid="ignore"):
            worst = np.nan_to_num(np.abs(residuals).max(axis=2), nan=np.inf)
        return [
            Explanation(elements, code, float(left), largest, self.experiments.part)
            for (elements, code), left, largest in zip(codes, root_mean_square(residuals), worst, strict=True)
        ]

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
        if only_moving and base.experiments.max(initial=0.0) > self.bound:
            deviation = -judged.residuals([base.code])[0] * judged.scale
            bound = self.bound * float(judged.scale.max())
            found += smooth_friction(self.model, judged.state[1], deviation, bound)
        return found


def _joint(elements: Sequence[Element]) -> CodeFault:
    """Faults as one that has the numbers of all of them."""

    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        for fault, numbers in _with_numbers(elements, x):
            code = fault.change(code, numbers)
        return code

    right = np.concatenate([fault.right for fault, _ in elements])
    start = np.concatenate([numbers for _, numbers in elements])
    return CodeFault(right, change, lambda x: [], start[None])


def _takes_steps(elements: Sequence[Element], own: DynamicsCode) -> bool:
    """Whether numbers of the faults can be fitted by complex steps: angles of a rotation that one of them turns cannot
    be taken of complex numbers."""
    joint = _joint(elements)
    stepped: Any = joint.right + 1j * COMPLEX_STEP
    try:
        joint.change(own, stepped)
    except TypeError:
        return False
    return True


def _with_numbers(elements: Sequence[Element], x: Array) -> tuple[Element, ...]:
    """The same faults with other numbers, those of all of them in a row."""
    ends = np.cumsum([len(numbers) for _, numbers in elements])[:-1]
    return tuple((fault, numbers) for (fault, _), numbers in zip(elements, np.split(x, ends), strict=True))


def _of_states(experiments: Observation, number: int) -> NDArray[np.bool_]:
    """Rows of the first and the last states."""
    _, first, of = np.unique(experiments.state[0][experiments.of], axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    return np.isin(of.ravel(), [*order[: (number + 1) // 2], *order[len(order) - number // 2 :]])
