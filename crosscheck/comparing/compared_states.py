"""The states of one case, on both sides: graphdyn's answers there, and those of one of Pinocchio's models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from crosscheck.quantities import TabulatedQuantity
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.states import Case
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from crosscheck.reference.subject import FRAME_REFERENCES
from graphdyn.layout import Array

SECOND_DERIVATIVE_STATES = slice(20)
"""States at which second derivatives are compared: those of the plain form take 10 ms each."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ComparedStates(ScaledStates):
    """States of a case; the sizes of errors come from Pinocchio, which must not depend on what is compared.

    case: its states are these; reference: Pinocchio's model of the robot, base and gravity turned as in the case
    regular: where the mass matrix is (N,)
    shared: the same states beside another of Pinocchio's models; what graphdyn answered there is not computed again
    """

    case: Case
    reference: PinocchioModel
    regular: NDArray[np.bool_]
    shared: ComparedStates | None = None

    def __post_init__(self) -> None:
        if self.shared is not None:
            object.__setattr__(self, "_answers", self.shared._answers)

    @classmethod
    def of(
        cls, case: Case, regular: NDArray[np.bool_], robot: PinocchioModel, shared: ComparedStates | None = None
    ) -> ComparedStates:
        """The states at the torques of the case, or at those that cause its accelerations. robot: not turned yet"""
        reference = robot.turned(case.turn, case.model.gravity)
        tau, shared = (reference.rnea(case.q, case.v, case.a), None) if case.tau is None else (case.tau, shared)
        return cls(
            case.model, case.q, case.v, case.a, tau, case=case, reference=reference, regular=regular, shared=shared
        )

    @cached_property
    def loaded(self) -> ComparedStates:
        """The answers with the external wrenches of the case."""
        return replace(self, loads=self.case.external_wrenches, shared=self.shared and self.shared.loaded)

    @cached_property
    def few(self) -> ComparedStates:
        return self.rows(SECOND_DERIVATIVE_STATES, self.shared and self.shared.few)

    @cached_property
    def solvable(self) -> ComparedStates:
        """States with a regular mass matrix."""
        return self if self.regular.all() else self.rows(self.regular, self.shared and self.shared.solvable)

    def rows(self, selected: slice | NDArray[np.bool_], shared: ComparedStates | None = None) -> ComparedStates:
        """Some of the states. shared: the same beside another of Pinocchio's models"""
        arrays = {name: getattr(self, name)[selected] for name in ("q", "v", "a", "tau", "regular")}
        return replace(self, **arrays, case=self.case.rows(selected), shared=shared)

    @cached_property
    def there(self) -> PinocchioAnswers:
        """Pinocchio's answers."""
        return PinocchioAnswers(self.reference, self.model, self.q, self.v, self.a, self.tau, self.loads, self.frame)

    origins = property(attrgetter("there.position"))
    rotations = property(attrgetter("there.rotation"))
    body_velocities = property(attrgetter("there.velocity"))
    body_accelerations = property(attrgetter("there.acceleration"))
    wrenches = property(attrgetter("there.joint_wrenches"))
    mass = property(attrgetter("there.mass_matrix"))
    solved = property(attrgetter("there.a", "there.a_body_accelerations", "there.a_wrenches"))

    def required(self, a: Array) -> tuple[Array, Array]:
        return self.there.required(a)

    def errors(self, quantity: TabulatedQuantity) -> Array:
        """Errors of a quantity of the table in one form; in frames the largest error of all references (N,)."""
        row, form = quantity.row, quantity.form
        states = self.loaded if form.loaded else self
        usual = next(row.readings({}))
        errors = [
            row.errors(
                row.of_graphdyn(states, chosen, form.method), row.pinocchio(states.there, chosen), states, chosen
            )
            for chosen in compared_readings(usual)
        ]
        largest: Array = np.maximum.reduce(errors)
        return largest


def compared_readings(usual: Mapping[str, str]) -> Iterator[Mapping[str, str]]:
    """The usual reading, with every reference for what has one."""
    if "reference" not in usual:
        yield usual
    else:
        yield from ({**usual, "reference": reference} for reference in FRAME_REFERENCES)
