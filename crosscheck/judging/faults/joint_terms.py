"""Torques that a joint has of its own: friction, springs, constants, rotors; a constant matrix added to M."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

import numpy as np

from crosscheck.judging.faults.fault import Family, FaultDescription
from crosscheck.judging.faults.recursion import DynamicsCode, State
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array

RIGID_BODY_REMEDY = "the dynamics of rigid bodies have no friction; switch it off for the comparison"
DRIVE_REMEDY = "rotor inertia (armature) belongs to the drives; switch it off for the comparison"

JOINT_TERMS: dict[str, tuple[str, str, str, Callable[[Array, Array, Array], Array]]] = {
    "viscous friction": ("friction", "N m s/rad or N s/m", RIGID_BODY_REMEDY, lambda q, v, a: v),
    "dry friction": ("friction", "N m or N", RIGID_BODY_REMEDY, lambda q, v, a: np.sign(v.real)),
    "a spring": ("spring", "N m/rad or N/m", "switch springs and joint stiffness off", lambda q, v, a: q),
    "a constant torque": ("offset", "N m or N", "take the offset away", lambda q, v, a: 1.0 + 0 * q),
    "a constant diagonal": ("rotor_inertia", "kg m² or kg", DRIVE_REMEDY, lambda q, v, a: a),
}
"""Torques of a joint alone: kind, unit, remedy, what they are proportional to."""


def joint_terms(model: RobotModel) -> Iterator[Family]:
    n = model.n_bodies
    yield Family(
        np.zeros(len(JOINT_TERMS) * n),
        lambda code, x: code.giving(lambda tau, state: tau + _added(x.reshape(-1, n), state)),
        lambda x: list(_said(model, x.reshape(-1, n))),
    )
    if n > 1:
        yield Family(np.zeros(n * (n + 1) // 2), _constant_inertia(n), lambda x: _matrix_said(model, x))


def _added(x: Array, state: State) -> Array:
    added: Array = 0 * state[0] * x[0]
    for row, (_, _, _, column) in zip(x, JOINT_TERMS.values(), strict=True):
        added = added + row * column(*state)
    return added


def _said(model: RobotModel, x: Array) -> Iterator[FaultDescription]:
    n = model.n_bodies
    terms = dict(zip(JOINT_TERMS, x, strict=True))
    slack = np.where(terms["a spring"] != 0, terms["a constant torque"], 0.0)
    terms["a constant torque"] = terms["a constant torque"] - slack
    present = {name: row for name, row in terms.items() if row.any()}
    both = {"viscous friction", "dry friction"} <= set(present)
    for name, row in present.items():
        kind, unit, remedy, _ = JOINT_TERMS[name]
        if both and name == "dry friction":
            continue
        which = [k for k in range(n) if row[k] != 0]
        numbers = tuple(FittedNumber(f"{name}, {model.joint_names[k]}", float(row[k]), 0.0, unit) for k in which)
        shown = f"{name} {_values(row, unit)}"
        if both and name == "viscous friction":
            dry = present["dry friction"]
            shown += f" and dry friction {_values(dry, JOINT_TERMS['dry friction'][1])}"
        if kind == "rotor_inertia":
            message = f"a constant diagonal ({', '.join(f'{x:.4g}' for x in row)}) is added to the mass matrix"
        elif len(which) == 1:
            (k,) = which
            at = f", slack at {-slack[k] / row[k]:.4g}," if kind == "spring" and slack[k] else ""
            message = f"{name} of {row[k]:.4g} {unit}{at} at joint '{model.joint_names[k]}' is included"
        else:
            message = f"{shown} per joint is included"
        size = 1 + len(which) + (int(np.count_nonzero(slack)) if kind == "spring" else 0)
        yield FaultDescription(kind, message, remedy, size, numbers)


def _values(row: Array, unit: str) -> str:
    return f"({', '.join(f'{x:.4g}' for x in row)}) {unit}"


def _constant_inertia(n: int) -> Callable[[DynamicsCode, Array], DynamicsCode]:
    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        return code.giving(lambda tau, state: tau + state[2] @ _symmetric(x, n))

    return change


def _symmetric(x: Array, n: int) -> Array:
    matrix = np.diag(x[:n])
    matrix[np.triu_indices(n, 1)] = x[n:]
    return matrix + np.triu(matrix, 1).T


def _matrix_said(model: RobotModel, x: Array) -> list[FaultDescription]:
    n = model.n_bodies
    pairs = [*((k, k) for k in range(n)), *itertools.combinations(range(n), 2)]
    numbers = tuple(
        FittedNumber(f"M[{i + 1}, {k + 1}]", float(value), 0.0, "kg m², kg m or kg")
        for (i, k), value in zip(pairs, x, strict=True)
        if value != 0
    )
    if not x[n:].any():
        return []
    said = ", ".join(f"{number.name} + {number.theirs:.4g}" for number in numbers)
    message = f"a constant matrix, as of coupled rotors, is added to the mass matrix: {said}"
    return [FaultDescription("rotor_inertia", message, DRIVE_REMEDY, 1 + len(numbers), numbers)]
