"""Wrong masses, centers of mass and tensors: axes, points, entries, exchanged bodies, other numbers."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

from crosscheck.judging.faults.fault import (
    FITTED_ZERO_SHARE,
    QUARTER_TURNS,
    Changed,
    CodeFault,
    FaultDescription,
    is_round,
    of_bodies,
    rounded,
    told_apart,
)
from crosscheck.judging.faults.recursion import DynamicsCode, Numbers
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array
from graphdyn.model import parallel_axis

UPPER_TRIANGLE = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
TENSOR_NAMES = ("I_xx", "I_xy", "I_xz", "I_yy", "I_yz", "I_zz")
"""Entries of a tensor as URDF writes them."""

OTHER_TENSOR_ORDERS = {
    "I_xx, I_yy, I_zz, I_xy, I_xz, I_yz": (0, 3, 5, 1, 2, 4),
    "I_xx, I_yy, I_zz, I_xy, I_yz, I_xz": (0, 3, 5, 1, 4, 2),
    "I_xx, I_yy, I_zz, I_yz, I_xz, I_xy": (0, 3, 5, 4, 2, 1),
    "I_xx, I_xy, I_yy, I_xz, I_yz, I_zz": (0, 1, 3, 2, 4, 5),
}
"""Other orders of the six numbers, as places in TENSOR_NAMES: MuJoCo's, SDF's and Voigt's, Pinocchio's."""


def inertials(model: RobotModel) -> Iterator[CodeFault]:
    axes = "the inertial frame's rotation turns the tensor into link axes: R J Rᵀ"
    for what, parts in TURNED_PARTS.items():
        inside: dict[str, Changed] = {
            f"{what} expressed in the axes of the inside body": lambda x, k, parts=parts: _turned(  # type: ignore[misc]
                parts, x.rotations[k].T, x, k
            ),
            f"{what} turned the wrong way": lambda x, k, parts=parts: _turned(parts, x.rotations[k], x, k),  # type: ignore[misc]
        }
        yield from of_bodies(model, "frame", axes, inside)
        turned = {
            f"{what} turned by {degrees}° about {name}": partial(_turned, parts, turn)
            for name, degrees, turn in QUARTER_TURNS
        }
        yield from of_bodies(model, "frame", axes, turned, size=2)
    principal = "the tensor of {who} is taken in its principal axes as if they were the link axes"
    yield from of_bodies(
        model, "frame", axes, {principal: lambda x, k: {"tensors": np.diag(np.linalg.eigvalsh(x.tensors[k]))}}
    )
    shifted = {message: partial(_shifted, factor) for factor, message in TENSOR_POINT_MESSAGES.items()}
    yield from of_bodies(model, "inertia_point", TENSOR_POINT_REMEDY, shifted)
    read_in_order = {
        f"the tensor of {{who}} is {way} in the order {names}": partial(_reordered, places)
        for names, written in OTHER_TENSOR_ORDERS.items()
        for places, way in {written: "written", tuple(np.argsort(written).tolist()): "read"}.items()
    }
    exchanged = {
        f"{TENSOR_NAMES[i]} and {TENSOR_NAMES[j]} of {{who}} are exchanged": partial(_reordered, _exchanged(6, i, j))
        for i, j in itertools.combinations(range(6), 2)
    }
    yield from of_bodies(
        model, "inertial_parameters", f"URDF writes {', '.join(TENSOR_NAMES)}", {**read_in_order, **exchanged}
    )
    yield from of_bodies(
        model,
        "inertial_parameters",
        "use the full tensor",
        {"the products of inertia of {who} are left out": lambda x, k: {"tensors": np.diag(np.diag(x.tensors[k]))}},
    )
    at_origin = "the center of mass of {who} is taken at the link origin"
    yield from of_bodies(
        model,
        "inertial_parameters",
        "use the center of mass in the link frame",
        {at_origin: lambda x, k: {"centers": np.zeros(3)}},
    )
    other_axes = {
        f"the center of mass of {{who}} is read in the order {', '.join('xyz'[i] for i in order)}": partial(
            _read, order
        )
        for order in itertools.permutations(range(3))
        if order != (0, 1, 2)
    }
    yield from of_bodies(model, "inertial_parameters", "read x, y, z", other_axes)
    for i, k in itertools.combinations(range(model.n_bodies), 2):
        names = f"'{model.body_names[i]}' and '{model.body_names[k]}'"
        message = f"the inertial parameters of bodies {names} are exchanged"
        change = partial(_assigned, _exchanged(model.n_bodies, i, k))
        yield CodeFault.of("inertial_parameters", message, "assign them by name", change)


TURNED_PARTS = {
    "the center of mass of {who} is": ("centers",),
    "the tensor of {who} is": ("tensors",),
    "center of mass and tensor of {who} are": ("centers", "tensors"),
}
"""What may be turned, in words, and its numbers."""

TENSOR_POINT_REMEDY = "a tensor about the center of mass needs m (c·c E - c cᵀ) more about the link origin"

TENSOR_POINT_MESSAGES = {
    -1.0: "the tensor of {who} is about the center of mass and used as if about the link origin",
    1.0: "the tensor of {who} is about the link origin and used as if about the center of mass",
    -2.0: "the parallel-axis term of {who} has the opposite sign",
}
"""Messages by what is wrongly added to the tensor about the center of mass, in parallel-axis terms."""


def _shifted(factor: float, x: Numbers, k: int) -> dict[str, Array]:
    return {"tensors": x.tensors[k] + factor * parallel_axis(x.masses[k], x.centers[k])}


def _read(order: Sequence[int], x: Numbers, k: int) -> dict[str, Array]:
    return {"centers": x.centers[k][list(order)]}


def _turned(parts: Sequence[str], rotation: Array, x: Numbers, k: int) -> dict[str, Array]:
    turned = {"centers": rotation @ x.centers[k], "tensors": rotation @ x.tensors[k] @ rotation.T}
    return {name: turned[name] for name in parts}


def _reordered(places: Sequence[int], x: Numbers, k: int) -> dict[str, Array]:
    return {"tensors": reordered_tensor(places, x.tensors[k])}


def reordered_tensor(places: Sequence[int], tensor: Array) -> Array:
    """The tensor whose six numbers stand at other places: number i of it is number places[i] of this one."""
    other = np.empty_like(tensor)
    for (i, j), place in zip(UPPER_TRIANGLE, places, strict=True):
        other[i, j] = other[j, i] = tensor[UPPER_TRIANGLE[place]]
    return other


def _exchanged(n: int, i: int, k: int) -> list[int]:
    order = list(range(n))
    order[i], order[k] = k, i
    return order


def _assigned(order: list[int], code: DynamicsCode) -> DynamicsCode:
    x = code.numbers
    return code.but(masses=x.masses[order], centers=x.centers[order], tensors=x.tensors[order])


MASS, CENTER, TENSOR = slice(0, 1), slice(1, 4), slice(4, 10)
"""Places among the ten numbers of a body: m, c, J about the center of mass."""

PARAMETER_LABELS = ("m", "c_x", "c_y", "c_z", *TENSOR_NAMES)
BODY_NUMBER_UNITS = ("kg", *3 * ("m",), *6 * ("kg m²",))

PARAMETER_GROUPS = {(0,): "the mass", (1, 2, 3): "the center of mass", tuple(range(4, 10)): "the tensor"}
"""Numbers that belong together."""

PARAMETER_SETS = (*PARAMETER_GROUPS, (0, 1, 2, 3), tuple(range(10)))
"""Numbers of one body that are fitted together."""

MAX_LISTED_NUMBERS = 4
"""Numbers that a message lists at most; the diagnosis has all of them."""

PARAMETER_REMEDY = "compare mass, center of mass and tensor, and the fixed links that the body carries"


def parameters(model: RobotModel) -> Iterator[CodeFault]:
    """Parameters of one body: one number, then several; of all bodies: factors."""
    for k in range(model.n_bodies):
        for places in [*PARAMETER_SETS, *((place,) for place in range(4, 10))]:
            yield of_body(model, k, places)
        for what, field in (("the center of mass", "centers"), ("the tensor", "tensors")):
            yield _factor(f"{what} of body '{model.body_names[k]}'", field, np.arange(model.n_bodies) == k)
    every = np.ones(model.n_bodies, dtype=bool)
    if model.n_bodies > 1:
        for what, field in (("the mass", "masses"), ("the center of mass", "centers"), ("the tensor", "tensors")):
            yield _factor(f"{what} of every body", field, every)
    yield CodeFault(
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


def of_body(model: RobotModel, k: int, places: tuple[int, ...]) -> CodeFault:
    """Some of the ten numbers of one body: as differences, so that it adds to other faults.

    That of a center is fitted times the mass: forces are linear in it, however light the body is.
    """
    name, own, which = model.body_names[k], ten_numbers(DynamicsCode.of(model), k), list(places)
    is_center = np.isin(which, range(10)[CENTER])

    def differences(mass: complex, x: Array) -> Array:
        whole = mass + x[0] if 0 in which else mass
        return np.where(is_center, x / whole, x) if whole else x

    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        ten = ten_numbers(code, k).astype(x.dtype)
        ten[which] = ten[which] + differences(ten[0], x)
        return with_ten_numbers(code, k, ten)

    def say(fitted: Array) -> Iterator[FaultDescription]:
        x = differences(own[0], fitted)
        moved = [i for i, difference in zip(which, x, strict=True) if difference != 0]
        numbers = tuple(
            FittedNumber(
                PARAMETER_LABELS[i], _or_zero(own[i] + difference, own[i]), float(own[i]), BODY_NUMBER_UNITS[i]
            )
            for i, difference in zip(which, x, strict=True)
            if i in moved
        )
        if moved:
            message = _message(name, moved, numbers)
            yield FaultDescription("inertial_parameters", message, PARAMETER_REMEDY, 1 + len(moved), numbers)

    return CodeFault(np.zeros(len(which)), change, say)


def _or_zero(theirs: float, ours: float) -> float:
    """Fitted numbers, zero where they are its rounding."""
    return 0.0 if abs(theirs) <= FITTED_ZERO_SHARE * abs(ours) else float(theirs)


def _message(name: str, moved: Sequence[int], numbers: Sequence[FittedNumber]) -> str:
    if len(moved) == 1 and moved[0] not in range(1, 4):
        (number,) = numbers
        what = "the mass" if moved == [0] else number.name
        return f"{what} of body '{name}' is {told_apart(number.theirs, number.ours, number.unit)}"
    what = " and ".join(word for places, word in PARAMETER_GROUPS.items() if set(places) & set(moved))
    if len(moved) > MAX_LISTED_NUMBERS:
        return f"other values of {what} of body '{name}' alone explain all numbers"
    off = ", ".join(f"{number.name} by {number.difference:.6g} {number.unit}" for number in numbers)
    return f"{what} of body '{name}' {'are' if ' and ' in what else 'is'} off: {off}"


def _factor(what: str, field: str, bodies: Array) -> CodeFault:
    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        array = getattr(code.numbers, field)
        return code.but(**{field: np.where(bodies.reshape(-1, *[1] * (array.ndim - 1)), x[0] * array, array)})

    return CodeFault(np.ones(1), change, lambda x: _scaled(what, x[0]), starts=np.array([[1.0], [1e3], [1e-3]]))


def _scaled(what: str, x: float) -> Iterator[FaultDescription]:
    factor = rounded(x)
    size = 1 if is_round(factor) else 2
    if factor == 1 or ("tensor" not in what and factor == -1) or ("center" in what and factor == 0):
        return  # no fault, or one of those of signs and inertials
    power = np.log10(abs(factor)) if factor else 0.0
    if power and power.is_integer():
        said = f"{what} multiplied by {'-' if factor < 0 else ''}1e{round(power)}"
        yield FaultDescription("unit", said, "use kg, m, kg m², N m", size)
    else:
        said = f"{what} multiplied by {factor:.6g}" if factor else f"{what} left out"
        yield FaultDescription("inertial_parameters", said, "use the values of the model", size)
