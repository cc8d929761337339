"""All errors of one cross-check, and the states of the largest ones."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from crosscheck.comparing.baseline import BaselineIdentification
from crosscheck.comparing.comparison import QuantityResult, WorstState
from crosscheck.comparing.conditioning import Conditioning
from crosscheck.quantities import COMPARED, COUPLED, LOOPED, ComparedQuantity
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.states import Case
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn.layout import Array

Part = tuple[str, Case | None, Array]
"""Route, case and errors (N,) of some states; no case for an error that belongs to all states together."""


class ErrorTable:
    """All errors so far, the conditioning, and where the mass matrix is singular."""

    def __init__(self) -> None:
        self._parts: defaultdict[str, list[Part]] = defaultdict(list)
        self._singular: Counter[str] = Counter()
        self.conditioning: Conditioning | None = None

    def add(self, route: str, case: Case, errors: Mapping[str, Array]) -> None:
        for name, values in errors.items():
            self._parts[name].append((route, case, np.where(np.isnan(values), np.inf, values)))

    def add_of_routes(
        self,
        case: Case,
        errors: Callable[[Case, ScaledStates, PinocchioModel], Mapping[str, Array]],
        pinocchio_models: Mapping[str, PinocchioModel],
    ) -> None:
        """Add what a function finds beside each of Pinocchio's models. errors: called with our side of the case"""
        ours = ScaledStates.at(case)
        for route, pinocchio in pinocchio_models.items():
            self.add(route, case, errors(case, ours, pinocchio))

    def add_identification(self, found: BaselineIdentification) -> None:
        """Add the error of the base parameters."""
        error = max(found.difference, found.error) if found.rank == found.rank_there else np.inf
        self._parts["base_parameters"].append(("model", None, np.array([error])))

    def count_singular(self, case: str, singular: NDArray[np.bool_]) -> None:
        """Count states with a singular mass matrix (N,)."""
        self._singular[case] += int(singular.sum())

    def singular_notes(self) -> list[str]:
        return [
            f"{count} of the states '{name}' have a singular mass matrix: forward quantities left out there"
            for name, count in self._singular.items()
            if count
        ]

    def condition(self, conditioning: Conditioning) -> None:
        self.conditioning = conditioning if self.conditioning is None else self.conditioning.merged(conditioning)

    def results(self) -> dict[str, QuantityResult]:
        known = {**COMPARED, **COUPLED, **LOOPED}
        return {name: _result(known[name], self._parts[name]) for name in known if name in self._parts}


def _result(quantity: ComparedQuantity, parts: Sequence[Part]) -> QuantityResult:
    by_case: dict[str, float] = {}
    by_route: dict[str, float] = {}
    for route, case, values in parts:
        for table, key in ((by_case, case.name if case else "all states"), (by_route, route)):
            table[key] = max(table.get(key, 0.0), float(values.max()))
    route, case, values = max(parts, key=lambda part: part[2].max())
    return QuantityResult(
        quantity,
        np.concatenate([values for _, _, values in parts]),
        float(values.max()),
        by_case,
        by_route,
        _worst_state(route, case, int(values.argmax())) if case else None,
    )


def _worst_state(route: str, case: Case, k: int) -> WorstState:
    """State k of a case as plain numbers."""
    return WorstState(
        route,
        case.name,
        q=tuple(case.q[k].tolist()),
        v=tuple(case.v[k].tolist()),
        a=tuple(case.a[k].tolist()),
        tau=None if case.tau is None else tuple(case.tau[k].tolist()),
        external_wrenches=tuple(map(tuple, case.external_wrenches[k].tolist())),
        turn=tuple(map(tuple, case.turn.rotation.tolist())),
        gravity=tuple(case.model.gravity.tolist()),
    )
