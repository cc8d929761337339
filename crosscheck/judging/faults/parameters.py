"""Other inertial parameters: masses, centers of mass and tensors, of one body or by one factor of all."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from crosscheck.judging.faults.changes import is_round, rounded
from crosscheck.judging.faults.fault import Family, FaultDescription
from crosscheck.judging.faults.inertials import TENSOR_NAMES, UPPER_TRIANGLE
from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array

MASS, CENTER, TENSOR = slice(0, 1), slice(1, 4), slice(4, 10)
"""Places among the ten numbers of a body: m, c, J about the center of mass."""

PARAMETER_LABELS = ("m", "c_x", "c_y", "c_z", *TENSOR_NAMES)
BODY_NUMBER_UNITS = ("kg", *3 * ("m",), *6 * ("kg m²",))

PARAMETER_GROUPS = {(0,): "the mass", (1, 2, 3): "the center of mass", tuple(range(4, 10)): "the tensor"}
"""Numbers that belong together."""

MAX_LISTED_NUMBERS = 4
"""Numbers that a message lists at most; the diagnosis has all of them."""

PARAMETER_REMEDY = "compare mass, center of mass and tensor, and the fixed links that the body carries"


def parameters(model: RobotModel) -> Iterator[Family]:
    """Parameters of one body: one number, then several; of all bodies: factors."""
    for k in range(model.n_bodies):
        for places in [*PARAMETER_GROUPS, *((place,) for place in range(4, 10)), (0, 1, 2, 3), tuple(range(10))]:
            yield _of_body(model, k, places)
        for what, field in (("the center of mass", "centers"), ("the tensor", "tensors")):
            yield _factor(f"{what} of body '{model.body_names[k]}'", field, np.arange(model.n_bodies) == k)
    every = np.ones(model.n_bodies, dtype=bool)
    if model.n_bodies > 1:
        for what, field in (("the mass", "masses"), ("the center of mass", "centers"), ("the tensor", "tensors")):
            yield _factor(f"{what} of every body", field, every)
    yield Family(
        np.ones(1),
        lambda code, x: code.giving(lambda tau, _: x[0] * tau),
        lambda x: _scaled("all inertial parameters of every body, or all torques,", x[0]),
    )


def ten_numbers(code: DynamicsCode, k: int) -> Array:
    """m, c, J of a body (10,)."""
    x = code.numbers
    return np.array([x.masses[k], *x.centers[k], *(x.tensors[k][i] for i in UPPER_TRIANGLE)])


def with_ten_numbers(code: DynamicsCode, k: int, ten: Array) -> DynamicsCode:
    x = code.numbers
    kind = np.result_type(ten, x.masses, x.centers, x.tensors)
    masses, centers, tensors = (np.array(array, kind) for array in (x.masses, x.centers, x.tensors))
    masses[k], centers[k] = ten[0], ten[CENTER]
    for (i, j), value in zip(UPPER_TRIANGLE, ten[TENSOR], strict=True):
        tensors[k, i, j] = tensors[k, j, i] = value
    return code.but(masses=masses, centers=centers, tensors=tensors)


def _of_body(model: RobotModel, k: int, places: tuple[int, ...]) -> Family:
    """Some of the ten numbers of one body: as differences, so that it adds to other faults."""
    name, own, which = model.body_names[k], ten_numbers(DynamicsCode.of(model), k), list(places)

    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        ten = ten_numbers(code, k).astype(x.dtype)
        ten[which] = ten[which] + x
        return with_ten_numbers(code, k, ten)

    def say(x: Array) -> list[FaultDescription]:
        moved = [i for i, difference in zip(which, x, strict=True) if difference != 0]
        numbers = tuple(
            FittedNumber(PARAMETER_LABELS[i], float(own[i] + difference), float(own[i]), BODY_NUMBER_UNITS[i])
            for i, difference in zip(which, x, strict=True)
            if i in moved
        )
        return (
            [
                FaultDescription(
                    "inertial_parameters", _message(name, moved, numbers), PARAMETER_REMEDY, 1 + len(moved), numbers
                )
            ]
            if moved
            else []
        )

    return Family(np.zeros(len(which)), change, say)


def _message(name: str, moved: Sequence[int], numbers: Sequence[FittedNumber]) -> str:
    if len(moved) == 1 and moved[0] not in range(1, 4):
        (number,) = numbers
        what = "the mass" if moved == [0] else number.name
        return f"{what} of body '{name}' is {number.theirs:.6g} {number.unit}, not {number.ours:.6g} {number.unit}"
    what = " and ".join(word for places, word in PARAMETER_GROUPS.items() if set(places) & set(moved))
    if len(moved) > MAX_LISTED_NUMBERS:
        return f"other values of {what} of body '{name}' alone explain all numbers"
    off = ", ".join(f"{number.name} by {number.difference:.6g} {number.unit}" for number in numbers)
    return f"{what} of body '{name}' {'are' if ' and ' in what else 'is'} off: {off}"


def _factor(what: str, field: str, bodies: Array) -> Family:
    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        array = getattr(code.numbers, field)
        return code.but(**{field: np.where(bodies.reshape(-1, *[1] * (array.ndim - 1)), x[0] * array, array)})

    return Family(np.ones(1), change, lambda x: _scaled(what, x[0]), starts=np.array([[1.0], [1e3], [1e-3]]))


def _scaled(what: str, x: float) -> list[FaultDescription]:
    factor = rounded(x)
    size = 1 if is_round(factor) else 2
    if factor == 1 or ("tensor" not in what and factor == -1) or ("center" in what and factor == 0):
        return []  # no fault, or one of those of signs and inertials
    if factor == 0:
        return [FaultDescription("inertial_parameters", f"{what} left out", "use the values of the model", size)]
    power = np.log10(abs(factor))
    if abs(factor) == 1 or not power.is_integer():
        return [
            FaultDescription(
                "inertial_parameters", f"{what} multiplied by {factor:.6g}", "use the values of the model", size
            )
        ]
    said = f"{what} multiplied by {'-' if factor < 0 else ''}1e{round(power)}"
    return [FaultDescription("unit", said, "use kg, m, kg m², N m", size)]
