"""The states of one case: exact values there, and how far the answers of each code are from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.comparing.accuracy.results import PINOCCHIO
from crosscheck.comparing.compared_states import ComparedStates, compared_readings
from crosscheck.exact import PLACEMENT, ExactArray, ExactSource, exact_placements, exact_values
from crosscheck.quantities import COMPARED, Quantity, TabulatedQuantity
from crosscheck.quantities.measures import Chosen
from crosscheck.quantities.scales import largest, ratio
from crosscheck.quantities.tolerances import EPS
from crosscheck.reference.subject import compared_frames, placed_frames
from graphdyn import SingularMassMatrix
from graphdyn.arguments import Method
from graphdyn.layout import Array
from graphdyn.verbs import VERBS

DIGITS = 20
"""Proven digits of the exact values: their radius is then a ten-thousandth of eps."""

MAGNIFIED = 2.0**40
"""Factor on errors while they are put on their scale, to which all measures are proportional. An error of some eps,
added to exact values that are rounded to double precision, would lose all its digits."""

METHODS: tuple[Method, ...] = ("recursive", "projected")
"""Methods of every verb; "dense" is added where the cross-check has it."""


@dataclass(frozen=True)
class MeasuredQuantity:
    """A row of the table, with or without external wrenches.

    methods: of graphdyn; everywhere: whether at the special states, too
    """

    name: str
    row: Quantity
    loaded: bool
    methods: tuple[Method, ...]
    everywhere: bool


def measured_quantities() -> dict[str, MeasuredQuantity | None]:
    """Every quantity of the cross-check by name, its methods as one; None for those without an exact form."""
    found: dict[str, MeasuredQuantity | None] = {}
    for quantity in COMPARED.values():
        if not isinstance(quantity, TabulatedQuantity):
            found[quantity.name] = None
            continue
        row, loaded = quantity.row, quantity.form.loaded
        forms = [form for form in row.forms if form.loaded == loaded]
        alone = len(forms) == len(row.forms)
        name = row.name if alone or not loaded else f"{row.name}_external"
        dense = any(form.method == "dense" for form in forms)
        methods: tuple[Method, ...] = (*METHODS, "dense") if dense else METHODS
        everywhere = any(form.when == "all" for form in forms)
        exact = row.ours.verb or row.name == PLACEMENT
        found[name] = MeasuredQuantity(name, row, loaded, methods, everywhere) if exact else None
    return found


@dataclass(frozen=True, eq=False)
class MeasuredStates:
    """States of a case; exact values are computed when they are first needed.

    source: the robot of these states, whose values are exact
    """

    states: ComparedStates
    source: ExactSource
    _known: dict[object, dict[str, ExactArray]] = field(default_factory=dict, repr=False)

    def errors(self, quantity: MeasuredQuantity, others: Mapping[str, Array]) -> dict[str, Array]:
        """Errors by code, in eps of the scale and of the largest exact value (2, N); of frames the largest of all
        references.

        others: answers of further codes, in the usual conventions
        """
        row, states = quantity.row, self.states.loaded if quantity.loaded else self.states
        found: dict[str, Array] = {}
        for chosen in compared_readings(next(row.readings({}))):
            exact = self._exact(row, states, chosen)
            answers = {str(method): row.of_graphdyn(states, chosen, method) for method in quantity.methods}
            for code, answer in {**answers, PINOCCHIO: row.pinocchio(states.there, chosen), **others}.items():
                errors = _on_scale(exact, answer, row, states, chosen)
                found[code] = np.maximum(found.get(code, 0.0), errors)
        return found

    def proven_regular(self) -> NDArray[np.bool_]:
        """Whether the mass matrix is proven regular (N,)."""
        q = self.states.q

        def proven(rows: Array) -> bool:
            try:
                exact_values(self.source, "mass_matrix_inverse", rows, digits=DIGITS)
            except SingularMassMatrix:
                return False
            return True

        return np.full(len(q), True) if proven(q) else np.array([proven(one) for one in q])

    def _exact(self, row: Quantity, states: ComparedStates, chosen: Chosen) -> list[ExactArray]:
        """The exact answer, or one for each of the compared frames."""
        if row.name == PLACEMENT:
            frames = placed_frames(states.model)
            return [exact_placements(self.source, states.q, name, digits=DIGITS) for name in frames]
        verb, options = VERBS[row.ours.verb], row.ours.options(chosen)
        spoken_of = compared_frames(states.model) if verb.of_frame else (None,)
        return [self._computed(states, verb.name, frame, options)[row.ours.output] for frame in spoken_of]

    def _computed(
        self, states: ComparedStates, verb: str, frame: str | None, options: Mapping[str, Any]
    ) -> dict[str, ExactArray]:
        """What a verb answers, in balls."""
        key = verb, states.loads is not None, frame, *sorted(options.items())
        if key not in self._known:
            given = [getattr(states, name) for name in VERBS[verb].inputs]
            asked = {"frame": frame, **options} if frame is not None else {}
            self._known[key] = exact_values(
                self.source, verb, *given, digits=DIGITS, external_wrenches=states.loads, **asked
            )
        return self._known[key]


def _on_scale(
    exact: Sequence[ExactArray], answer: Array, row: Quantity, states: ComparedStates, chosen: Chosen
) -> Array:
    """Errors (2, N) of an answer (N, …), of several frames (N, frames, …), in eps of the scale and of the largest
    exact value; infinite for NaN."""
    finite = np.isfinite(answer)
    filled = np.where(finite, answer, 0.0)
    parts = np.moveaxis(filled, 1, 0) if row.of_frame else [filled]
    values = [one.doubles() for one in exact]
    apart = [one.errors(part)[0] for one, part in zip(exact, parts, strict=True)]
    true, away = (np.stack(x, axis=1) if row.of_frame else x[0] for x in (values, apart))
    on_scale = row.errors(true + MAGNIFIED * away, true, states, chosen) / MAGNIFIED
    errors = np.stack([on_scale, ratio(largest(away), largest(true))]) / EPS
    return np.where(finite.reshape(len(answer), -1).all(axis=1), errors, np.inf)
