"""Factors on the parts of a function of q, v and a: what it is at rest, and what accelerations and velocities add.

Derivatives of forward dynamics are read as what they are solved from: ∂a/∂x = −M⁻¹ ∂τ/∂x at the accelerations that
belong to the torques.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from crosscheck.judging.faults.fault import FaultDescription, factor_said, round_factor
from crosscheck.judging.observing.references import relative_errors
from crosscheck.judging.searching.found_fault import FoundFault
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS, Quantity
from crosscheck.quantities.measures import Chosen
from graphdyn.layout import Array

SOLVED_FROM = {
    "da_dq": "dtau_dq",
    "da_dv": "dtau_dv",
    "forward_dynamics_parameter_derivatives": "joint_torque_regressor",
}
"""Functions of q, v, τ that are −M⁻¹ times another one."""

MISTAKEN_FACTORS = (0.0, -1.0, 2.0, 0.5, 1.0)
"""What a part is multiplied by where the code has a mistake; other factors belong to numbers of the robot."""

MIN_PART_SHARE = 1e-9
"""Part of the largest answer below which a part is rounding."""

PARTS_REMEDY = "compare the terms of the function at rest, accelerated from rest, and moving at a = 0"


def part_fault(
    known: Quantity, answer: Array, states: JudgedStates, declared: Chosen, bound: float
) -> FoundFault | None:
    """The factors, or for derivatives of forward dynamics a wrong acceleration or M⁻¹ left out; by any reading."""
    for chosen in known.readings(declared):
        for said, made in _explanations(known, answer, states, chosen):
            left = float(relative_errors(known, answer, made, states, chosen).max())
            if left <= bound:
                return FoundFault(said, left, chosen)
    return None


def _explanations(
    known: Quantity, answer: Array, states: JudgedStates, chosen: Chosen
) -> Iterator[tuple[FaultDescription, Array]]:
    """What may be wrong, and the answers that it gives."""
    if known.name in SOLVED_FROM:
        inner = FUNCTIONS[SOLVED_FROM[known.name]]
        right = states.but(a=states.answer("forward_dynamics").a)
        yield from _unsolved(inner, states, right)
        given, parts = -states.mass @ answer, _parts(inner, right, chosen)
        for said, made in _factors(given, parts):
            yield said, _solved(states, made)
    elif {"q", "v", "a"} <= set(known.arguments) or {"q", "v"} == set(known.arguments):
        yield from _factors(answer, _parts(known, states, chosen))


def _unsolved(inner: Quantity, states: JudgedStates, right: JudgedStates) -> Iterator[tuple[FaultDescription, Array]]:
    matrix = inner.of_graphdyn(right, {})
    for sign, what in ((-1.0, f"-{inner.name}"), (1.0, inner.name)):
        message = f"M⁻¹ is left out: the answers are {what} at the accelerations that belong to the torques"
        remedy = f"solve with the mass matrix: -M⁻¹ {inner.name}"
        yield FaultDescription("other_function", message, remedy), np.asarray(sign * matrix)
    if states.model.n_bodies > 1:
        diagonal = np.einsum("nii->ni", states.mass)[..., None]
        message = f"{inner.name} is divided by the diagonal of M, not multiplied by M⁻¹"
        yield FaultDescription("other_function", message, "solve with the mass matrix"), -matrix / diagonal
    if matrix.shape[-1] == states.mass.shape[-1]:
        inverse = np.linalg.inv(states.mass)
        message = f"{inner.name} is multiplied by M⁻¹ from the right, not from the left"
        yield FaultDescription("transposed", message, f"-M⁻¹ {inner.name}"), np.asarray(-matrix @ inverse)
    message = f"M, not M⁻¹, is multiplied with {inner.name}"
    yield FaultDescription("other_function", message, "solve with the mass matrix"), np.asarray(-states.mass @ matrix)
    message = f"the torques are taken in place of the accelerations in {inner.name}"
    remedy = "compute the accelerations by forward dynamics first"
    swapped = inner.of_graphdyn(states.but(a=states.tau), {})
    yield FaultDescription("argument", message, remedy), _solved(states, swapped)
    without = np.linalg.solve(states.mass, states.tau[..., None])[..., 0].astype(float)
    message = "the accelerations are M⁻¹ τ: bias and gravity are not subtracted from the torques"
    remedy = "the accelerations are M⁻¹ (τ - h)"
    yield FaultDescription("argument", message, remedy), _solved(states, inner.of_graphdyn(states.but(a=without), {}))


def _solved(states: JudgedStates, matrix: Array) -> Array:
    return -np.linalg.solve(states.mass, matrix).astype(float)


def _parts(known: Quantity, states: JudgedStates, chosen: Chosen) -> dict[str, Array]:
    """Answers at rest, and what accelerations and velocities alone add, those that are not zero."""
    still = {name: 0 * getattr(states, name) for name in "va" if name in known.arguments}
    rest = known.of_graphdyn(states.but(**still), chosen)
    parts = {"the part at rest, of gravity,": rest}
    for name, what in (
        ("a", "the part of the accelerations, at v = 0,"),
        ("v", "the part of the velocities, at a = 0,"),
    ):
        if name in still:
            parts[what] = known.of_graphdyn(states.but(**{**still, name: getattr(states, name)}), chosen) - rest
    largest = max(float(np.abs(part).max()) for part in parts.values())
    return {what: part for what, part in parts.items() if np.abs(part).max() > MIN_PART_SHARE * largest}


def _factors(answer: Array, parts: dict[str, Array]) -> Iterator[tuple[FaultDescription, Array]]:
    if len(parts) < 2 or not np.isfinite(answer).all():
        return
    columns = np.stack([part.ravel() for part in parts.values()], axis=1)
    found = [round_factor(float(x)) for x in np.linalg.lstsq(columns, answer.ravel(), rcond=None)[0]]
    if any(x not in MISTAKEN_FACTORS for x in found) or all(x == 1 for x in found):
        return
    wrong = [factor_said(what, x) for what, x in zip(parts, found, strict=True) if x != 1]
    said = FaultDescription("coriolis", "; ".join(wrong), PARTS_REMEDY, len(wrong))
    yield said, np.tensordot(np.stack(list(parts.values()), axis=-1), found, axes=1)
