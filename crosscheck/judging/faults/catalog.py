"""The catalog: faults of dynamics codes, families whose numbers are fitted, and faults that are read off the answers.

Read off the answers are the numbers of torques that are cut off, and of smooth laws of friction.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from crosscheck.judging.faults.arguments import angles, arguments, orders, units
from crosscheck.judging.faults.fault import COMPLEX_STEP, CodeFault
from crosscheck.judging.faults.geometry import frames, geometry
from crosscheck.judging.faults.inertials import inertials, parameters
from crosscheck.judging.faults.signs import signs
from crosscheck.judging.faults.terms import RIGID_BODY_REMEDY, gravity, joint_terms, terms
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array
from graphdyn.model import unit_of

MIN_EQUAL_ANSWERS = 2
"""Answers of one size, the largest, from which on it may be a limit."""

TRIAL_WIDTHS = (0.02, 0.1, 0.5)
"""Start values of the search for the width of a friction law, as a part of the largest velocity."""

Law = Callable[[Array, Array], Array]


def _tanh(x: Array, v: Array) -> Array:
    """d v + c tanh(v / w)."""
    torque: Array = x[0] * v + x[1] * np.tanh(v / x[2])
    return torque


def _stribeck(x: Array, v: Array) -> Array:
    """(c + s exp(-(v / w)²)) tanh(v / u)."""
    torque: Array = x[0] * v + (x[1] + x[3] * np.exp(-((v / x[4]) ** 2))) * np.tanh(v / x[2])
    return torque


FRICTION_LAWS: dict[str, tuple[Law, tuple[str, ...], int]] = {
    "tanh": (_tanh, ("viscous", "dry", "width of tanh"), 3),
    "Stribeck": (_stribeck, ("viscous", "dry", "width of tanh", "Stribeck torque", "Stribeck velocity"), 5),
}
FRICTION_UNITS = (("N m s/rad", "N s/m"), ("N m", "N"), ("rad/s", "m/s"), ("N m", "N"), ("rad/s", "m/s"))
"""Units of the numbers of a law of friction: of a joint that turns, of one that slides."""


def limits(model: RobotModel, torque: Array) -> Iterator[CodeFault]:
    """Torques (N, n) that are cut off: several answers of one joint have its largest size."""
    size = np.abs(torque)
    largest = size.max(axis=0)
    equal = (size >= largest * (1 - 1e-12)).sum(axis=0) >= MIN_EQUAL_ANSWERS
    level = np.where(equal & (largest > 0), largest, np.inf)
    which = np.flatnonzero(np.isfinite(level))
    if len(which):
        said = ", ".join(f"'{model.joint_names[k]}' at {level[k]:.6g}" for k in which)
        numbers = tuple(
            FittedNumber(
                f"largest torque, {model.joint_names[k]}",
                float(level[k]),
                np.inf,
                unit_of([model.joints[k]], "N m", "N"),
            )
            for k in which
        )
        unit = unit_of([model.joints[k] for k in which], "N m", "N")
        message = f"torques are clipped, at a limit: {said} {unit}"
        yield CodeFault.of(
            "clipped",
            message,
            "take the limit of the torques away for the comparison",
            lambda code: code.giving(lambda tau, _: np.clip(tau, -level, level)),
            1 + len(which),
            numbers,
        )


def smooth_friction(model: RobotModel, v: Array, deviation: Array, bound: float) -> Iterator[CodeFault]:
    """Laws of friction fitted to deviations (N, n) of torques at velocities v (N, n), joint by joint; bound: [N m].

    None where a joint at rest deviates: no law gives it a torque.
    """
    if (np.abs(deviation[v == 0]) > bound).any():
        return
    for name, (law, labels, p) in FRICTION_LAWS.items():
        found = np.zeros((p, v.shape[1]))
        found[[2, -1]] = 1.0
        which = [k for k in range(v.shape[1]) if np.abs(deviation[:, k]).max() > bound]
        for k in which:
            found[:, k] = _fitted(law, p, v[:, k], deviation[:, k])
            if np.abs(law(found[:, k], v[:, k]) - deviation[:, k]).max() > bound:
                break  # it must fit every joint
        weak = np.abs(found[0]) * np.abs(v).max(axis=0) <= bound
        found[0] = np.where(weak, 0.0, found[0])
        left = np.abs(law(found, v) - deviation).max() if which else np.inf
        if left > bound:
            continue
        numbers = tuple(
            FittedNumber(f"{label}, {model.joint_names[k]}", float(x), 0.0, unit_of([model.joints[k]], *units))
            for k in which
            for label, x, units in zip(labels, found[:, k], FRICTION_UNITS, strict=False)
            if x != 0
        )
        shown = "; ".join(
            f"{label} ({', '.join(f'{x:.4g}' for x in row[which])})"
            for label, row in zip(labels, found, strict=True)
            if row[which].any()
        )
        yield CodeFault.of(
            "friction",
            f"friction by a {name} law is included: {shown}",
            RIGID_BODY_REMEDY,
            lambda code, x=found, law=law: code.giving(lambda tau, state: tau + law(x, state[1])),  # type: ignore[misc]
            1 + p * len(which),
            numbers,
        )


def _fitted(law: Law, p: int, v: Array, deviation: Array) -> Array:
    from scipy.optimize import least_squares  # imported where first used: most judgments fit no friction

    largest = np.abs(v).max()
    size = np.abs(deviation).max()

    def slopes(x: Array) -> Array:
        """Exact derivatives (N, p)."""
        steps = x[:, None] + 1j * COMPLEX_STEP * np.eye(p)
        return law(steps[..., None], v).imag.T / COMPLEX_STEP

    best = None
    for width in TRIAL_WIDTHS:
        for stribeck in TRIAL_WIDTHS if p == 5 else (1.0,):
            start = np.array([0.0, size / 2, width * largest, size / 2, stribeck * largest])[:p]
            scale = np.array([size / largest, size, largest, size, largest])[:p]
            found = least_squares(
                lambda x: law(x, v) - deviation,
                start,
                slopes,
                x_scale=scale,
                method="lm",
                xtol=1e-15,
                ftol=1e-15,
                gtol=1e-15,
            )
            if best is None or found.cost < best.cost:
                best = found
    assert best is not None
    return np.asarray(best.x)


def faults(model: RobotModel) -> Iterator[CodeFault]:
    """All faults without free numbers, but those in reading a file."""
    for kinds in (signs, units, angles, arguments, frames, inertials, orders):
        yield from kinds(model)


def families(model: RobotModel) -> Iterator[CodeFault]:
    """All families of faults."""
    for kinds in (gravity, terms, geometry, parameters, joint_terms):
        yield from kinds(model)
