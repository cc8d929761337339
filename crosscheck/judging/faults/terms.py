"""Wrong terms of the recursion and of the velocity torques, another gravity vector, and torques that a joint adds.

The velocity torques c(q, v) are taken apart into the sums that codes compute, so that a wrong factor on one term can be
found: as a whole, and in three decompositions: spatial vectors, Lagrange, and squares and products of joint velocities.
That of Newton and Euler is in the recursion itself (crosscheck.judging.faults.recursion).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import (
    FITTED_ZERO_SHARE,
    CodeFault,
    FaultDescription,
    factor_said,
    is_round,
    rounded,
    told_apart,
)
from crosscheck.judging.faults.recursion import DynamicsCode, State, torques_of
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel, maximal_state
from graphdyn.equations import null_space
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model import apply, cross

Terms = dict[str, Array]
"""Torques (N, n) by the name of the term; their sum is c."""


def velocity_terms(model: RobotModel, q: Array, v: Array) -> tuple[Terms, ...]:
    """c(q, v) as a whole, and in three decompositions; q, v: (N, n)."""
    whole = _velocity_torque(model, q, v)
    return {"all velocity terms": whole}, _spatial(model, q, v, whole), *_christoffel(model, q, v)


def _velocity_torque(model: RobotModel, q: Array, v: Array) -> Array:
    weightless = DynamicsCode.of(model).but(gravity=np.zeros(3))
    (torque,) = torques_of([weightless], (q, v, np.zeros_like(v)))
    return torque  # type: ignore[no-any-return]


def _spatial(model: RobotModel, q: Array, v: Array, whole: Array) -> Terms:
    """v ×* I v of every body, v its twist at the link origin, and the rest, from v × S q̇ in the accelerations."""
    state = maximal_state(model, q, v)
    omega = state.velocity[..., ANGULAR]
    center = np.stack([body.center_of_mass for body in model.bodies])
    masses = np.array([body.mass for body in model.bodies])[:, None]
    at_center = np.einsum("...iba,...ib->...ia", state.rotation, state.velocity[..., LINEAR])
    at_origin = at_center - cross(omega, center)
    momentum = masses * at_center
    tensors = np.stack([body.inertia for body in model.bodies])
    spin = np.einsum("iab,...ib->...ia", tensors, omega) + cross(center, momentum)  # about the link origin
    force = cross(omega, momentum)
    moment = cross(omega, spin) + cross(at_origin, momentum) - cross(center, force)  # about the center
    world: Array = np.einsum("...iab,...ib->...ia", state.rotation, force)
    wrench = np.concatenate([world, moment], axis=-1)  # forces in world axes, moments in body axes
    bias = apply(np.swapaxes(null_space(state), -1, -2), wrench.reshape(len(wrench), -1))
    return {"the bias wrenches v ×* I v": bias, "the terms v × S q̇ in the accelerations": whole - bias}


def _christoffel(model: RobotModel, q: Array, v: Array) -> tuple[Terms, Terms]:
    """Ṁ v and the gradient of the kinetic energy; squares and products of the joint velocities.

    c_i = Σ Γ_ijk v_j v_k, from c at unit velocities and their sums: exact, since c is quadratic.
    """
    n = model.n_bodies
    unit = np.eye(n)
    pairs = (unit[:, None] + unit[None, :]).reshape(-1, n)
    repeated = np.repeat(q, n * n, axis=0)
    sums = _velocity_torque(model, repeated, np.tile(pairs, (len(q), 1))).reshape(len(q), n, n, n)
    singles = np.einsum("sjji->sji", sums) / 4  # c(2 e_j) = 4 c(e_j)
    symbols = np.moveaxis((sums - singles[:, :, None] - singles[:, None, :]) / 2, -1, 1)  # (N, i, j, k)
    whole = np.einsum("sijk,sj,sk->si", symbols, v, v)
    gradient = np.einsum("sjik,sj,sk->si", symbols, v, v)
    squares = np.einsum("sijj,sj->si", symbols, v**2)
    return (
        {"the term Ṁ v": whole + gradient, "the gradient of the kinetic energy, -½ ∂(vᵀ M v)/∂q": -gradient},
        {"the squares v_j²": squares, "the products v_j v_k": whole - squares},
    )


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


def terms(model: RobotModel) -> Iterator[CodeFault]:
    n, names = model.n_bodies, list(EVERYWHERE)
    slides = np.array([joint.is_prismatic for joint in model.joints])

    def everywhere(code: DynamicsCode, x: Array) -> DynamicsCode:
        return code.but(**{name: factor * np.ones(n) for name, factor in zip(names, x, strict=True)})

    yield CodeFault(np.ones(4), everywhere, partial(_said, list(EVERYWHERE.values()), "coriolis"))
    for field, text in AT_ONE.items():
        kind = "gravity" if field == "weight" else "coriolis"
        for k in range(n):
            if slides[k] != (field == "sliding") and field in ("cross", "sliding"):
                continue
            name = text.format(joint=model.joint_names[k], body=model.body_names[k])
            at = np.arange(n) == k
            yield CodeFault(np.ones(1), partial(_at_one, field, at), partial(_said, [name], kind))
    yield from _decompositions(model)


def _at_one(field: str, at: NDArray[np.bool_], code: DynamicsCode, x: Array) -> DynamicsCode:
    return code.but(**{field: np.where(at, x[0], getattr(code.numbers, field))})


def _decompositions(model: RobotModel) -> Iterator[CodeFault]:
    """Factors on the terms of each decomposition of c(q, v), graphdyn's: added to the torques."""

    @lru_cache(maxsize=8)
    def known(q: bytes, v: bytes) -> tuple[Terms, ...]:
        shape = -1, model.n_bodies
        return velocity_terms(model, np.frombuffer(q).reshape(shape), np.frombuffer(v).reshape(shape))

    def change(number: int, code: DynamicsCode, x: Array) -> DynamicsCode:
        def added(tau: Array, state: State) -> Array:
            pieces = known(state[0].tobytes(), state[1].tobytes())[number]
            together: Array = tau + np.tensordot(x - 1, np.stack(list(pieces.values())), axes=1)
            return together

        return code.giving(added)

    for number, names in enumerate(map(list, velocity_terms(model, *np.zeros((2, 1, model.n_bodies))))):
        yield CodeFault(np.ones(len(names)), partial(change, number), partial(_said, names, "coriolis"))


def _said(names: Sequence[str], kind: str, x: Array) -> Iterator[FaultDescription]:
    wrong = {name: rounded(factor) for name, factor in zip(names, x, strict=True) if rounded(factor) != 1}
    if wrong:
        message = "; ".join(factor_said(name, factor) for name, factor in wrong.items())
        size = sum(1 if is_round(factor) else 2 for factor in wrong.values())
        yield FaultDescription(kind, message, TERM_REMEDY, size)


GRAVITY_ROUNDING = 1e-6
"""Accuracy of fitted components [m/s²], well below what makes a difference."""


def gravity(model: RobotModel) -> Iterator[CodeFault]:
    """Components in axes of the ground, to which torques at rest are linear."""
    ours = model.base.rotation.T @ model.gravity
    yield CodeFault(ours, lambda code, g: code.but(gravity=g), lambda g: [_gravity_message(ours, g)])


def _gravity_message(ours: Array, found: Array) -> FaultDescription:
    shown, here = (", ".join(f"{x:.6g}" for x in np.where(np.abs(g) < GRAVITY_ROUNDING, 0.0, g)) for g in (found, ours))
    factor = float(found @ ours / (ours @ ours)) if ours.any() else np.nan
    size = 1
    if not np.abs(found).max() > GRAVITY_ROUNDING:
        message = "gravity is left out"
    elif np.abs(found + ours).max() < GRAVITY_ROUNDING:
        message = "gravity has the opposite sign"
    elif np.abs(found - factor * ours).max() < GRAVITY_ROUNDING:
        message = f"gravity is {told_apart(float(np.linalg.norm(found)), float(np.linalg.norm(ours)), 'm/s²')}"
    else:
        size = 2
        message = f"gravity acts along ({shown}), not ({here}) m/s², or the base is turned"
    numbers = tuple(
        FittedNumber(f"g_{axis}", 0.0 if abs(x) < GRAVITY_ROUNDING else float(x), float(y), "m/s²")
        for axis, x, y in zip("xyz", found, ours, strict=True)
    )
    remedy = f"use the gravity vector ({here}) m/s² in the axes of the base"
    return FaultDescription("gravity", message, remedy, size, numbers)


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


def joint_terms(model: RobotModel) -> Iterator[CodeFault]:
    n = model.n_bodies
    yield CodeFault(
        np.zeros(len(JOINT_TERMS) * n),
        lambda code, x: code.giving(lambda tau, state: tau + _added(x.reshape(-1, n), state)),
        lambda x: _joint_descriptions(model, x.reshape(-1, n)),
    )
    if n > 1:
        yield CodeFault(
            np.zeros(n * (n + 1) // 2),
            lambda code, x: code.giving(lambda tau, state: tau + state[2] @ _symmetric(x, n)),
            lambda x: _matrix_said(model, x),
        )


def _added(x: Array, state: State) -> Array:
    added: Array = 0 * state[0] * x[0]
    for row, (_, _, _, column) in zip(x, JOINT_TERMS.values(), strict=True):
        added = added + row * column(*state)
    return added


def _joint_descriptions(model: RobotModel, x: Array) -> Iterator[FaultDescription]:
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


def _symmetric(x: Array, n: int) -> Array:
    matrix = np.diag(x[:n])
    matrix[np.triu_indices(n, 1)] = x[n:]
    return matrix + np.triu(matrix, 1).T


def _matrix_said(model: RobotModel, x: Array) -> Iterator[FaultDescription]:
    n = model.n_bodies
    x = np.where(np.abs(x) > FITTED_ZERO_SHARE * np.abs(x).max(initial=0.0), x, 0.0)
    pairs = [*((k, k) for k in range(n)), *itertools.combinations(range(n), 2)]
    numbers = tuple(
        FittedNumber(f"M[{i + 1}, {k + 1}]", float(value), 0.0, "kg m², kg m or kg")
        for (i, k), value in zip(pairs, x, strict=True)
        if value != 0
    )
    if x[n:].any():
        said = ", ".join(f"{number.name} + {number.theirs:.4g}" for number in numbers)
        message = f"a constant matrix, as of coupled rotors, is added to the mass matrix: {said}"
        yield FaultDescription("rotor_inertia", message, DRIVE_REMEDY, 1 + len(numbers), numbers)
