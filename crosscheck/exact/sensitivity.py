"""How far values move with the inputs they are computed from: what half an ulp of every state and constant causes.

Derivatives of the recorded recursions by all their inputs, in doubles, all states at once: one sweep from the outputs
back to the inputs (reverse mode, Griewank and Walther, "Evaluating Derivatives", 2008, chapter 3).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from crosscheck.exact.balls import bits
from crosscheck.exact.recorded import CONSTANTS, constants_of, recorded
from crosscheck.exact.robot import of_model
from graphdyn import RobotModel
from graphdyn.arguments import Reference, frame_choice
from graphdyn.compiler import Request
from graphdyn.layout import Array
from graphdyn.recursions import ARRAY_SPECS
from graphdyn.scalars import Program
from graphdyn.verbs import VERBS

DOUBLE_BITS = 53

HALF_ULP = 2.0**-DOUBLE_BITS
"""Largest relative error of rounding to the nearest double."""


def half_ulp_effects(
    model: RobotModel,
    verb: str,
    output: str,
    *arguments: Array,
    external_wrenches: Array | None = None,
    frame: str | None = None,
    reference: Reference | None = None,
    classical: bool = True,
) -> Array:
    """What an output of a verb moves by at N states, to first order, if every input moves by half an ulp, each so that
    it does most: Σ ∣∂output/∂input∣ × half an ulp of the input   (N, …).

    Inputs are the states and all constants of the robot. Entries of rotations and axes move by half an ulp of 1, for
    they come from sines and cosines; those of vectors and tensors by half an ulp of the norm of the whole, for codes
    keep them in other axes too. Positions, velocities, accelerations and torques move by half an ulp of their own.

    arguments: as the verb takes them, (N, n); the others as in exact_values
    """
    chosen = None if frame is None or reference is None else frame_choice(model, frame, reference, classical)
    request = Request(VERBS[verb].recursion, (output,), external_wrenches is not None, frame=chosen)
    with bits(DOUBLE_BITS):
        robot = of_model(model)
        program = recorded(robot, request, all_inputs=True).program
        known = np.array([float(x.mid()) for x in constants_of(robot, request)])
    given = {name: np.asarray(x, dtype=float) for name, x in zip(VERBS[verb].inputs, arguments, strict=True)}
    moved = {name: HALF_ULP * np.abs(x) for name, x in given.items()}
    if external_wrenches is not None:
        parts = np.reshape(external_wrenches, (len(external_wrenches), -1, 3))  # forces and moments
        given["external_wrenches"] = parts.reshape(len(parts), -1)
        moved["external_wrenches"] = HALF_ULP * np.repeat(np.linalg.norm(parts, axis=-1), 3, axis=-1)
    moved[CONSTANTS] = HALF_ULP * sizes_of_constants(model, request, known)
    values = _values(program, {**given, CONSTANTS: known})
    swept = _swept(program, program.outputs[output], values, moved)
    found: Array = swept.T.reshape(-1, *ARRAY_SPECS[output].shape_for(model))
    return found


def sizes_of_constants(model: RobotModel, request: Request, known: Array) -> Array:
    """Sizes in the order of constants_of: 1 for rotations, for others the norm of the vector or tensor."""
    unit = {"rotation": 9, "link_axes": 9}
    link = {"rotation": 9, "translation": 3, "link_axes": 9, "mass": 1, "center": 3, "first_moment": 3, "tensor": 9}
    root = {"rotation": 9, "position": 3, "gravity": 3, "compensated": 3}
    frame = {"rotation": 9, "translation": 3} if request.frame is not None else {}
    sizes, at = np.ones_like(known), 0
    for name, size in [*(list(link.items()) * model.n_bodies), *root.items(), *frame.items()]:
        if name not in unit:
            sizes[at : at + size] = np.linalg.norm(known[at : at + size])
        at += size
    return sizes


def _values(program: Program, inputs: Mapping[str, Array]) -> list[Any]:
    """What each operation gives, (N,) or a number."""
    values: list[Any] = []
    for kind, *operands in program.operations:
        if kind == "constant":
            values.append(operands[0])
        elif kind == "input":
            name, column = operands
            values.append(inputs[name][..., column])
        elif kind in _OF_ONE:
            values.append(_OF_ONE[kind](values[operands[0]]))
        else:
            values.append(_OF_TWO[kind](*(values[k] for k in operands)))
    return values


_OF_ONE = {"negate": np.negative, "sine": np.sin, "cosine": np.cos}
_OF_TWO = {"+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide}


def _swept(program: Program, outputs: tuple[int, ...], values: list[Any], moved: Mapping[str, Array]) -> Array:
    """Σ ∣∂outputs/∂input∣ × what the input is moved by (m, N)."""
    count = max(len(x) for name, x in moved.items() if name != CONSTANTS)
    growth: dict[int, Any] = {}
    for row, number in enumerate(outputs):
        growth.setdefault(number, np.zeros((len(outputs), count)))[row] = 1.0
    total = np.zeros((len(outputs), count))
    for number in range(len(program.operations) - 1, -1, -1):
        if number not in growth:
            continue
        own = growth.pop(number)
        kind, *operands = program.operations[number]
        if kind == "input":
            name, column = operands
            total += np.abs(own) * moved[name][..., column]
            continue
        for k, part in _parts(kind, operands, own, values, number):
            growth[k] = growth[k] + part if k in growth else part
    return total


def _parts(kind: str, operands: list[Any], own: Array, values: list[Any], number: int) -> list[tuple[int, Array]]:
    """What grows with the operands of an operation that grows by `own`."""
    if kind == "constant":
        return []
    first = operands[0]
    if kind == "negate":
        return [(first, -own)]
    if kind == "sine":
        return [(first, own * np.cos(values[first]))]
    if kind == "cosine":
        return [(first, -own * np.sin(values[first]))]
    second = operands[1]
    x, y = values[first], values[second]
    if kind == "+":
        return [(first, own), (second, own)]
    if kind == "-":
        return [(first, own), (second, -own)]
    if kind == "*":
        return [(first, own * y), (second, own * x)]
    quotient = own / y
    return [(first, quotient), (second, -quotient * values[number])]
