"""All errors of one cross-check, and the states of the largest ones."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from crosscheck.comparing.baseline import BaselineIdentification
from crosscheck.comparing.comparison import QuantityResult, WorstState
from crosscheck.comparing.conditioning import Conditioning
from crosscheck.quantities import COMPARED, COUPLED, LOOPED
from crosscheck.quantities.states import Case
from graphdyn.layout import Array


class ErrorTable:
    """All errors so far, and the states of the largest ones."""

    def __init__(self) -> None:
        self._errors: dict[str, list[Array]] = {}
        self._by_case: dict[str, dict[str, float]] = {}
        self._by_route: dict[str, dict[str, float]] = {}
        self._worst: dict[str, tuple[float, WorstState | None]] = {}
        self._singular: Counter[str] = Counter()
        self.conditioning: Conditioning | None = None

    def add(self, route: str, case: Case, errors: Mapping[str, Array]) -> None:
        for name, values in errors.items():
            values = np.where(np.isnan(values), np.inf, values)
            k = int(values.argmax())
            self._note(name, route, case.name, values)
            if name not in self._worst or values[k] > self._worst[name][0]:
                self._worst[name] = float(values[k]), _worst_state(route, case, k)

    def add_identification(self, found: BaselineIdentification) -> None:
        """Add the error of the base parameters, which belongs to all samples together."""
        missing = abs(found.rank - found.rank_there)
        error = np.inf if missing else max(found.difference, found.error)
        self._note("base_parameters", "model", "all states", np.array([error]))
        self._worst["base_parameters"] = error, None

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
        return {
            name: QuantityResult(
                quantity,
                np.concatenate(self._errors[name]),
                self._worst[name][0],
                self._by_case[name],
                self._by_route[name],
                self._worst[name][1],
            )
            for name, quantity in {**COMPARED, **COUPLED, **LOOPED}.items()
            if name in self._worst
        }

    def _note(self, name: str, route: str, case: str, values: Array) -> None:
        self._errors.setdefault(name, []).append(values)
        for table, key in ((self._by_case, case), (self._by_route, route)):
            row = table.setdefault(name, {})
            row[key] = max(row.get(key, 0.0), float(values.max()))


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
