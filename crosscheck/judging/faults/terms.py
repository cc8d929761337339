"""Terms of the recursion left out, reversed or multiplied, of all bodies or of one; another gravity vector."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.changes import factor_said, is_round, rounded
from crosscheck.judging.faults.fault import Family, FaultDescription
from crosscheck.judging.faults.recursion import DynamicsCode, State
from crosscheck.judging.faults.velocity_terms import velocity_terms
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array

EVERYWHERE = {
    "centripetal": "the centripetal accelerations ω × (ω × r)",
    "cross": "the terms ω × q̇ p in the angular accelerations",
    "gyroscopic": "the gyroscopic moments ω × I ω",
    "sliding": "the Coriolis accelerations 2 ω × ṡ of sliding joints",
}
"""Factors of the recursion, in the words for all joints and bodies."""

AT_ONE = {
    "centripetal": "the centripetal acceleration ω × (ω × r) at joint '{joint}' and body '{body}'",
    "cross": "the term ω × q̇ p at joint '{joint}'",
    "gyroscopic": "the gyroscopic moment ω × I ω of body '{body}'",
    "sliding": "the Coriolis acceleration 2 ω × ṡ at joint '{joint}'",
    "weight": "gravity on body '{body}'",
    "carried": "the angular velocity of the inside body, at joint '{joint}',",
}

TERM_REMEDY = "check that term in the recursion of velocities and accelerations"


def terms(model: RobotModel) -> Iterator[Family]:
    n, names = model.n_bodies, list(EVERYWHERE)
    slides = np.array([joint.is_prismatic for joint in model.joints])

    def everywhere(code: DynamicsCode, x: Array) -> DynamicsCode:
        return code.but(**{name: factor * np.ones(n) for name, factor in zip(names, x, strict=True)})

    yield Family(np.ones(4), everywhere, partial(_said, list(EVERYWHERE.values()), "coriolis"))
    for field, text in AT_ONE.items():
        kind = "gravity" if field == "weight" else "coriolis"
        for k in range(n):
            if slides[k] != (field == "sliding") and field in ("cross", "sliding"):
                continue
            name = text.format(joint=model.joint_names[k], body=model.body_names[k])
            at = np.arange(n) == k
            yield Family(np.ones(1), partial(_at_one, field, at), partial(_said, [name], kind))
    for number in range(len(velocity_terms(model, *np.zeros((2, 1, n))))):
        yield _decomposition(model, number)


def _at_one(field: str, at: NDArray[np.bool_], code: DynamicsCode, x: Array) -> DynamicsCode:
    return code.but(**{field: np.where(at, x[0], getattr(code.numbers, field))})


def _decomposition(model: RobotModel, number: int) -> Family:
    """Factors on the terms of a decomposition of c(q, v), graphdyn's: added to the torques."""

    @lru_cache(maxsize=8)
    def known(q: bytes, v: bytes) -> dict[str, Array]:
        shape = -1, model.n_bodies
        return velocity_terms(model, np.frombuffer(q).reshape(shape), np.frombuffer(v).reshape(shape))[number]

    def added(state: State, x: Array) -> Array:
        pieces = known(np.ascontiguousarray(state[0]).tobytes(), np.ascontiguousarray(state[1]).tobytes())
        together: Array = np.tensordot(x - 1, np.stack(list(pieces.values())), axes=1)
        return together

    names = list(velocity_terms(model, *np.zeros((2, 1, model.n_bodies)))[number])
    return Family(
        np.ones(len(names)),
        lambda code, x: code.giving(lambda tau, state: tau + added(state, x)),
        partial(_said, names, "coriolis"),
    )


def _said(names: Sequence[str], kind: str, x: Array) -> list[FaultDescription]:
    wrong = {name: rounded(factor) for name, factor in zip(names, x, strict=True) if rounded(factor) != 1}
    if not wrong:
        return []
    size = sum(1 if is_round(factor) else 2 for factor in wrong.values())
    return [
        FaultDescription(
            kind, "; ".join(factor_said(name, factor) for name, factor in wrong.items()), TERM_REMEDY, size
        )
    ]


GRAVITY_ROUNDING = 1e-6
"""Accuracy of fitted components [m/s²], well below what makes a difference."""


def gravity(model: RobotModel) -> Iterator[Family]:
    """Components in axes of the ground, to which torques at rest are linear."""
    ours = model.base.rotation.T @ model.gravity
    yield Family(ours, lambda code, g: code.but(gravity=g), lambda g: [_gravity_message(ours, g)])


def _gravity_message(ours: Array, found: Array) -> FaultDescription:
    shown, here = (", ".join(f"{x:.6g}" for x in np.where(np.abs(g) < GRAVITY_ROUNDING, 0.0, g)) for g in (found, ours))
    factor = float(found @ ours / (ours @ ours)) if ours.any() else np.nan
    size = 1
    if not np.abs(found).max() > GRAVITY_ROUNDING:
        message = "gravity is left out"
    elif np.abs(found + ours).max() < GRAVITY_ROUNDING:
        message = "gravity has the opposite sign"
    elif np.abs(found - factor * ours).max() < GRAVITY_ROUNDING:
        message = f"gravity is {np.linalg.norm(found):.6g} m/s², not {np.linalg.norm(ours):.6g} m/s²"
    else:
        size = 2
        message = f"gravity acts along ({shown}), not ({here}) m/s², or the base is turned"
    numbers = tuple(
        FittedNumber(f"g_{axis}", float(x), float(y), "m/s²") for axis, x, y in zip("xyz", found, ours, strict=True)
    )
    remedy = f"use the gravity vector ({here}) m/s² in the axes of the base"
    return FaultDescription("gravity", message, remedy, size, numbers)
