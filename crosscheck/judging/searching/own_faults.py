"""Faults that only one function of the table can have."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from crosscheck.judging.observing.columns import column_fault
from crosscheck.judging.searching.answer_faults import FoundFault
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities.scales import largest
from crosscheck.quantities.spans import column_space, outside_of
from graphdyn import RobotModel
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model import PARAMETER_NAMES

MAX_LISTED_COLUMNS = 6
"""Columns that a message lists at most."""

OwnFault = Callable[[Array, Array, JudgedStates, float], FoundFault | None]
"""(answers, graphdyn's, states, bound) → the fault; None if it is none of those known here."""


def _of_columns(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    found = column_fault(answer, ours, states.model)
    return None if found is None else FoundFault(found[0].kind, found[0].message, found[0].remedy, found[1])


def _of_coriolis_matrix(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """C v is right, which leaves Ṁ - 2C."""
    size = np.maximum(largest(ours @ states.v[..., None]), largest(states.mass) * largest(states.v) ** 2)
    left = float((largest((answer - ours) @ states.v[..., None]) / np.where(size > 0, size, 1.0)).max())
    if not left <= bound:
        return None
    message = "C v is right, but C + Cᵀ is not Ṁ: Ṁ - 2C is not skew"
    remedy = "enough for C v + g; laws that need Ṁ - 2C skew, such as passivity, take C of the Christoffel symbols"
    return FoundFault("not_skew", message, remedy, left)


def _of_base_regressor(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    if not np.isfinite(answer).all():
        return None
    tested = [str(k + 1) for k in np.flatnonzero(outside_of(answer, ours).max(axis=(0, 1)) > bound)]
    missing = np.flatnonzero(outside_of(ours, answer).max(axis=(0, 1)) > bound)
    ranks = f"rank {column_space(answer).shape[1]}, not {column_space(ours).shape[1]}"
    said = []
    if tested:
        said.append(f"no combination of the columns of inertial parameters gives columns {_listed(tested)}")
    if len(missing):
        names = [_parameter(states.model, int(k)) for k in missing]
        said.append(f"no combination of its columns gives those of {_listed(names)}")
    message = f"{'; '.join(said)} ({ranks})"
    remedy = "compare these columns; friction and drives are no inertial parameters"
    return FoundFault("column_space", message, remedy, np.inf)


def _parameter(model: RobotModel, k: int) -> str:
    return f"{PARAMETER_NAMES[k % BODY_PARAMETERS]} of body '{model.body_names[k // BODY_PARAMETERS]}'"


def _listed(names: list[str]) -> str:
    rest = len(names) - MAX_LISTED_COLUMNS
    return ", ".join(names[:MAX_LISTED_COLUMNS]) + (f" and {rest} more" if rest > 0 else "")


OWN_FAULTS: Mapping[str, OwnFault] = {
    "joint_torque_regressor": _of_columns,
    "base_regressor": _of_base_regressor,
    "coriolis_matrix": _of_coriolis_matrix,
}
"""Own faults by the name of the function."""
