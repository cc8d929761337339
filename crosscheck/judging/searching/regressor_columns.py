"""Columns of regressors in another order, scaled, or of another space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import ROUND_NUMBER_TOLERANCE, FaultDescription
from crosscheck.judging.searching.found_fault import FoundFault
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities.measures import column_space, outside_of
from graphdyn import RobotModel
from graphdyn.errors import first_of
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model import PARAMETER_NAMES

MAX_COLUMN_REMAINDER = 1e-6
"""Part of a column that may remain after subtracting a multiple of another one to count as that multiple."""


def of_columns(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    """The columns are ours in another order or scale. answer, ours: (N, …, 10n), of body regressors (N, n, 6, 10)"""
    model = states.model
    if not np.isfinite(answer).all():
        return None
    if ours.shape[-1] == BODY_PARAMETERS < BODY_PARAMETERS * model.n_bodies:
        answer, ours = (_as_columns(x) for x in (answer, ours))
    answer, ours = (x.reshape(len(x), -1, x.shape[-1]) for x in (answer, ours))
    remedy = f"use {', '.join(PARAMETER_NAMES)} about the link origin, body after body"
    here = _by_body(ours)
    by_type = np.moveaxis(answer.reshape(*answer.shape[:2], BODY_PARAMETERS, -1), (2, 3), (1, 0))
    grouped = by_type.reshape(model.n_bodies, BODY_PARAMETERS, -1)
    layouts = (
        ("", _by_body(answer)),
        ("the columns are grouped by type (m of every body, then mc_x of every body, …)", grouped),
    )
    for layout, there in layouts:
        if (bodies := _bodies(there, here)) is None:
            continue
        arranged = here[bodies]
        if (matched := _types(there, arranged)) is None:
            continue
        places, factors, left = matched
        said = [layout] if layout else []
        if list(bodies) != list(range(model.n_bodies)):
            said.append(f"the columns are in the order of the bodies {', '.join(model.body_names[k] for k in bodies)}")
        if places != list(range(BODY_PARAMETERS)):
            order = ", ".join(PARAMETER_NAMES[k] for k in places)
            said.append(f"the ten columns of each body are in the order {order}")
        wrong = [
            f"{PARAMETER_NAMES[place]} × {factor:.4g}"
            for place, factor in zip(places, factors, strict=True)
            if abs(factor - 1) > ROUND_NUMBER_TOLERANCE
        ]
        if wrong:
            said.append(f"{'' if said else 'columns are '}scaled: {', '.join(wrong)}")
        shown = np.array(factors)[here.any(axis=(0, 2))]
        if len(said) == 1 and wrong and np.ptp(shown) <= ROUND_NUMBER_TOLERANCE:
            return None  # one factor on all answers
        if said:
            return FoundFault(FaultDescription("parameter_order", ", ".join(said), remedy), left)
    return None


def _as_columns(regressor: Array) -> Array:
    """Body regressors (N, n, 6, 10) side by side (N, 6, 10 n)."""
    return np.concatenate(np.moveaxis(regressor, 1, 0), axis=-1)


def _by_body(regressor: Array) -> Array:
    """All entries of the ten columns of each body: (N, r, 10 n) → (n, 10, N r)."""
    size, rows = regressor.shape[:2]
    apart = np.moveaxis(regressor.reshape(size, rows, -1, BODY_PARAMETERS), (2, 3), (0, 1))
    return apart.reshape(*apart.shape[:2], -1)


def _bodies(there: Array, here: Array) -> NDArray[np.intp] | None:
    """Our body of each of their blocks of ten columns; None if they are not ours in another order."""
    n = len(here)
    if _types(there, here) is not None:
        return np.arange(n)
    size = np.array([[np.abs(x - y).max() for y in here] for x in there])
    bodies = size.argmin(axis=1)
    exact = size[np.arange(n), bodies] <= MAX_COLUMN_REMAINDER * np.abs(here).max()
    return bodies if exact.all() and sorted(bodies) == list(range(n)) else None


def _types(there: Array, here: Array) -> tuple[list[int], list[float], float] | None:
    """Our parameter and the factor of each of their ten columns, the same for all bodies, and what is left."""
    theirs, ours = (np.moveaxis(x, 1, 0).reshape(BODY_PARAMETERS, -1) for x in (there, here))
    places, factors, left = [], [], 0.0
    sizes = (ours**2).sum(axis=1)
    for k, column in enumerate(theirs):
        if not column.any() and not ours[k].any():  # such as tensors in potential energies
            places.append(k)
            factors.append(1.0)
            continue
        factor = np.divide(ours @ column, sizes, out=np.zeros_like(sizes), where=sizes > 0)
        rest = np.abs(column - factor[:, None] * ours).max(axis=1) / (np.abs(column).max() or 1.0)
        best = int(rest.argmin())
        if not rest[best] <= MAX_COLUMN_REMAINDER:
            return None
        places.append(best)
        factors.append(float(factor[best]))
        left = max(left, float(rest[best]))
    return (places, factors, left) if sorted(places) == list(range(BODY_PARAMETERS)) else None


MAX_LISTED_COLUMNS = 6
"""Columns that a message lists at most."""


def of_base_regressor(answer: Array, ours: Array, states: JudgedStates, bound: float) -> FoundFault | None:
    if not np.isfinite(answer).all():
        return None
    tested = [str(k + 1) for k in np.flatnonzero(outside_of(answer, ours).max(axis=(0, 1)) > bound)]
    missing = np.flatnonzero(outside_of(ours, answer).max(axis=(0, 1)) > bound)
    theirs, here = (column_space(x).shape[1] for x in (answer, ours))
    ranks = f"rank {theirs}, not {here}" if theirs != here else f"both of rank {here}"
    said = []
    if tested:
        said.append(
            f"no combination of the columns of inertial parameters gives columns {first_of(tested, MAX_LISTED_COLUMNS)}"
        )
    if len(missing):
        names = [_parameter(states.model, int(k)) for k in missing]
        said.append(f"no combination of its columns gives those of {first_of(names, MAX_LISTED_COLUMNS)}")
    message = f"{'; '.join(said)} ({ranks})"
    remedy = "compare these columns; friction and drives are no inertial parameters"
    return FoundFault(FaultDescription("column_space", message, remedy), np.inf)


def _parameter(model: RobotModel, k: int) -> str:
    return f"{PARAMETER_NAMES[k % BODY_PARAMETERS]} of body '{model.body_names[k // BODY_PARAMETERS]}'"
