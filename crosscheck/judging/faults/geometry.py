"""Wrong placements and axes of joints: rotations, axes of translations, zeros and scales of coordinates."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from functools import partial

import numpy as np

from crosscheck.judging.faults.arguments import scaled_arguments
from crosscheck.judging.faults.fault import (
    AXES,
    QUARTER_TURNS,
    Changed,
    CodeFault,
    FaultDescription,
    is_round,
    of_joints,
    opposite_rotation_from,
    rounded,
)
from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, turned_about
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array
from urdf.document import rpy_from_rotation


def frames(model: RobotModel) -> Iterator[CodeFault]:
    changes: dict[str, Changed] = {
        "the rotation of {who} is transposed": lambda x, j: {"rotations": x.rotations[j].T},
        "the rotation of {who} is left out": lambda x, j: {"rotations": np.eye(3)},
        "the rpy angles of {who} are applied in the opposite order": lambda x, j: {
            "rotations": opposite_rotation_from(rpy_from_rotation(x.rotations[j]))
        },
        "the translation of {who} is expressed in the axes of the joint frame": lambda x, j: {
            "translations": x.rotations[j] @ x.translations[j]
        },
        "the translation of {who} is expressed in the axes of the joint frame and turned the wrong way": lambda x, j: {
            "translations": x.rotations[j].T @ x.translations[j]
        },
        "the translation of {who} is left out": lambda x, j: {"translations": np.zeros(3)},
        "the translation of {who} has the opposite sign": lambda x, j: {"translations": -x.translations[j]},
        "the placement of {who} is inverted": lambda x, j: {
            "rotations": x.rotations[j].T,
            "translations": -x.rotations[j].T @ x.translations[j],
        },
        "the axis of {who} is expressed in the inside body's axes": lambda x, j: {"axes": x.rotations[j].T @ x.axes[j]},
    }
    yield from of_joints(model, "frame", PLACEMENT_REMEDY, changes)
    for name, axis in AXES.items():
        taken = {f"the axis of {{who}} is taken as {name}": partial(_other_axis, axis)}
        yield from of_joints(model, "frame", "read the axis from the model", taken)
    carried = [k for k, joint in enumerate(model.joints) if joint.inside > 0]  # the others: gravity, or a turned base
    turned = {
        f"the placement of {{who}} is turned by {degrees}° about its {name} axis": partial(_turned, turn)
        for name, degrees, turn in QUARTER_TURNS
    }
    yield from of_joints(model, "frame", PLACEMENT_REMEDY, turned, size=2, joints=carried)


def _other_axis(axis: Array, x: Numbers, k: int) -> dict[str, Array]:
    return {"axes": axis}


def _turned(turn: Array, x: Numbers, k: int) -> dict[str, Array]:
    return {"rotations": x.rotations[k] @ turn}


PLACEMENT_REMEDY = "compare the placement of the joint frame in the inside body's link frame (forward kinematics)"

TRIAL_ZEROS = np.arange(-11, 13)[:, None] * np.pi / 12
"""Start values of the search for the zero of a joint [rad]."""

TRIAL_SCALES = np.array([[1.0], [-1.0], [0.5], [2.0], [np.pi / 180], [0.0]])

TRIVIAL_SCALES = (1.0, -1.0)
"""Factors that are no fault, or one of the faults of signs."""

COUPLING_TRIALS = np.array([[0.0], [1.0], [-1.0]])


def geometry(model: RobotModel) -> Iterator[CodeFault]:
    n = model.n_bodies
    for k, name in enumerate(model.joint_names):
        at, slides = np.arange(n) == k, model.joints[k].is_prismatic
        yield _translation(model, k)
        yield _rotation(k, f"the placement of joint '{name}' is turned", "rotations")
        yield _rotation(k, f"the axis of joint '{name}' is tilted", "axes")
        yield _zero(name, k, slides)
        yield _gear(name, at)
        for which, what in (
            ("qva", "position, velocity and acceleration"),
            ("q", "the position"),
            ("v", "the velocity"),
            ("a", "the acceleration"),
        ):
            yield _scale(f"{what} of joint '{name}'", at, which)
    for k, i in itertools.permutations(range(n), 2):
        for transmitted in (True, False):
            yield _coupled(model, k, i, transmitted)
    for k, name in enumerate(model.joint_names):
        yield _long_axis(f"joint '{name}'", np.arange(n) == k)
    if n > 1:
        yield _long_axis("every joint", np.ones(n, dtype=bool))


def _translation(model: RobotModel, k: int) -> CodeFault:
    ours, name = model.joints[k].placement.translation, model.joint_names[k]

    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        moved = code.numbers.translations.astype(x.dtype)
        moved[k] = moved[k] + x
        return code.but(translations=moved)

    def say(x: Array) -> Iterator[FaultDescription]:
        numbers = tuple(
            FittedNumber(axis, float(own + d), float(own), "m")
            for axis, own, d in zip("xyz", ours, x, strict=True)
            if d != 0
        )
        if numbers:
            moved = ", ".join(f"{number.name} by {number.difference:.6g} m" for number in numbers)
            message = f"the translation of joint '{name}' is off: {moved}"
            yield FaultDescription("geometry", message, PLACEMENT_REMEDY, 1 + len(numbers), numbers)

    return CodeFault(np.zeros(3), change, say)


def _rotation(k: int, message: str, field: str) -> CodeFault:
    """A small turn of the joint frame, or of its axis, by a vector [rad]: Cayley's, differentiable at zero."""

    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        array = getattr(code.numbers, field).astype(x.dtype)
        s = np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])
        array[k] = (np.eye(3) + (s + s @ s / 2) / (1 + x @ x / 4)) @ array[k]
        return code.but(**{field: array})

    def say(x: Array) -> Iterator[FaultDescription]:
        if x.any():
            size = float(np.linalg.norm(x))
            number = FittedNumber("turned by", 2 * np.arctan(size / 2), 0.0, "rad")
            said = f"{message} by {number.theirs:.6g} rad about ({', '.join(f'{value:.4g}' for value in x / size)})"
            yield FaultDescription("geometry", said, PLACEMENT_REMEDY, 4, (number,))

    return CodeFault(np.zeros(3), change, say)


def _zero(name: str, k: int, slides: bool) -> CodeFault:
    """The joint frame moved along or about the axis: position q + x instead of q."""
    unit = "m" if slides else "rad"

    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        rotations, translations = (y.astype(x.dtype) for y in (code.numbers.rotations, code.numbers.translations))
        axis = code.numbers.axes[k]
        if slides:
            translations[k] = translations[k] + rotations[k] @ axis * x[0]
        else:
            rotations[k] = rotations[k] @ turned_about(axis, x[0])
        return code.but(rotations=rotations, translations=translations)

    def say(x: Array) -> Iterator[FaultDescription]:
        off = float(x[0])
        part = off / np.pi * 2
        shown = f"{round(part)} π/2" if not slides and abs(part - round(part)) < 1e-6 else f"{off:.6g}"
        said = f"the zero of joint '{name}' is off by {shown} {unit}: its position is taken as q + that"
        if off:
            number = FittedNumber("zero", off, 0.0, unit)
            yield FaultDescription("zero", said, "use the zero of the model, or pass q shifted", 2, (number,))

    return CodeFault(np.zeros(1), change, say, starts=np.zeros((1, 1)) if slides else TRIAL_ZEROS)


def _gear(name: str, at: Array) -> CodeFault:
    def say(x: Array) -> Iterator[FaultDescription]:
        factor = rounded(x[0])
        ratio = rounded(1 / factor) if factor else 0.0
        shown = f"1/{ratio:g}" if abs(ratio) > 1 and ratio.is_integer() else f"{factor:.6g}"
        what = "left out" if factor == 0 else f"multiplied by {shown}, as by a gear"
        if factor not in TRIVIAL_SCALES:
            message = f"the torque of joint '{name}' is {what}"
            yield FaultDescription("gear", message, "give torques at the joint", 1 if is_round(factor) else 2)

    return CodeFault(np.ones(1), lambda code, x: code.giving(lambda tau, _: tau * np.where(at, x[0], 1.0)), say)


def _long_axis(who: str, at: Array) -> CodeFault:
    """An axis that is no unit vector: it multiplies the motion, and the torque about it."""

    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        scale = np.where(at, x[0], 1.0)
        return code.taking(scaled_arguments(scale, "qva")).giving(lambda tau, _: tau * scale)

    def say(x: Array) -> Iterator[FaultDescription]:
        factor = rounded(x[0])
        if factor not in TRIVIAL_SCALES:
            message = f"motion and torque of {who} are multiplied by {factor:.6g}, as by an axis of that length"
            yield FaultDescription("gear", message, "an axis is a unit vector: divide it by its length", 2)

    return CodeFault(np.ones(1), change, say, starts=TRIAL_SCALES)


def _scale(what: str, at: Array, which: str) -> CodeFault:
    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        return code.taking(scaled_arguments(np.where(at, x[0], 1.0), which))

    def say(x: Array) -> Iterator[FaultDescription]:
        factor = rounded(x[0])
        if factor not in TRIVIAL_SCALES:
            message = f"{what} {'are' if ' and ' in what else 'is'} multiplied by {factor:.6g}"
            yield FaultDescription("gear", message, "pass rad, m, rad/s, m/s of the joint, not of a motor", 2)

    return CodeFault(np.ones(1), change, say, starts=TRIAL_SCALES)


def _coupled(model: RobotModel, k: int, i: int, transmitted: bool) -> CodeFault:
    """q_k + x q_i instead of q_k, the same for v and a; the torques by the transpose, or not."""
    first, second = model.joint_names[k], model.joint_names[i]
    back = "" if transmitted else "; the torques do not"

    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        matrix = np.eye(model.n_bodies, dtype=x.dtype)
        matrix[k, i] = x[0]
        code = code.taking(lambda q, v, a: (q @ matrix.T, v @ matrix.T, a @ matrix.T))
        return code.giving(lambda tau, _: tau @ matrix) if transmitted else code

    def say(x: Array) -> Iterator[FaultDescription]:
        factor = rounded(x[0])
        if factor:
            message = f"joint '{first}' turns with joint '{second}' too, by a factor {factor:.6g}{back}"
            yield FaultDescription("coupling", message, "joint coordinates are relative to the inside body", 2)

    return CodeFault(np.zeros(1), change, say, starts=COUPLING_TRIALS)
