"""Both sides of a quantity at its worst state: the numbers behind an error."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from crosscheck.comparing.compared_states import ComparedStates, compared_readings
from crosscheck.comparing.comparison import Comparison, QuantityResult, WorstState
from crosscheck.quantities import TabulatedQuantity
from crosscheck.quantities.states import Case
from crosscheck.reference.pinocchio_model import PinocchioModel
from graphdyn import Placement
from graphdyn.layout import Array


def both_sides(comparison: Comparison, result: QuantityResult) -> tuple[Array, Array] | None:
    """graphdyn's and Pinocchio's answer where the error is largest, in one shape; in frames, in the worst reference.

    None for what is no single answer: ranks, base parameters, quantities of robots with couplings or loops.
    """
    worst, quantity = result.worst, result.quantity
    if worst is None or not isinstance(quantity, TabulatedQuantity):
        return None
    states = _states(comparison, worst)
    row, form = quantity.row, quantity.form
    states = states.loaded if form.loaded else states
    found: list[tuple[float, Array, Array]] = []
    for chosen in compared_readings(next(row.readings({}))):
        ours, theirs = row.of_graphdyn(states, chosen, form.method), row.pinocchio(states.there, chosen)
        found.append((float(row.errors(ours, theirs, states, chosen)[0]), ours[0], theirs[0]))
    _, ours, theirs = max(found, key=lambda each: np.inf if np.isnan(each[0]) else each[0])
    return ours, theirs


def _states(comparison: Comparison, worst: WorstState) -> ComparedStates:
    model, turn = comparison.model, Placement(np.array(worst.turn))
    if worst.route == "model" or comparison.file is None:
        native = PinocchioModel.from_model(model)
    else:
        native = PinocchioModel.from_urdf(Path(comparison.file), model, comparison.reading)
    if not np.array_equal(worst.turn, np.eye(3)):
        model = model.with_base(turn @ model.base)
    q, v, a, wrenches = (np.array([getattr(worst, name)]) for name in ("q", "v", "a", "external_wrenches"))
    tau = None if worst.tau is None else np.array([worst.tau])
    case = Case(worst.case, model.with_gravity(worst.gravity), turn, q, v, a, tau, wrenches)
    return ComparedStates.of(case, np.ones(1, dtype=bool), native)
