"""Wrong masses, centers of mass and tensors: axes, points, entries, exchanged bodies, other numbers."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from crosscheck.judging.faults.fault import (
    E1,
    E2,
    E3,
    Changed,
    CodeFault,
    FaultDescription,
    is_round,
    of_bodies,
    rounded,
)
from crosscheck.judging.faults.recursion import DynamicsCode, Numbers
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array
from graphdyn.model import parallel_axis, rotation_about

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
    turned: tuple[tuple[str, bool, bool, bool], ...] = (
        ("the center of mass of {who} is expressed in the axes of the inside body", True, False, False),
        ("the center of mass of {who} is turned the wrong way", True, False, True),
        ("the tensor of {who} is expressed in the axes of the inside body", False, True, False),
        ("the tensor of {who} is turned the wrong way", False, True, True),
        ("center of mass and tensor of {who} are expressed in the axes of the inside body", True, True, False),
        ("center of mass and tensor of {who} are turned the wrong way", True, True, True),
    )
    for message, center, tensor, wrong_way in turned:
        yield from of_bodies(
            model, "frame", message, axes,
            lambda x, k, which=(center, tensor, wrong_way): _turned(  # type: ignore[misc]
                x, k, x.rotations[k] if which[2] else x.rotations[k].T, *which[:2]
            ),
        )  # fmt: skip
    for name, axis in (("x", E1), ("y", E2), ("z", E3)):
        for degrees in (90, 180, 270):
            r = rotation_about(axis, np.deg2rad(degrees))
            for what, center, tensor in (
                ("center of mass and tensor of {who} are", True, True),
                ("the tensor of {who} is", False, True),
                ("the center of mass of {who} is", True, False),
            ):
                yield from of_bodies(
                    model, "frame", f"{what} turned by {degrees}° about {name}", axes,
                    lambda x, k, r=r, which=(center, tensor): _turned(x, k, r, *which), size=2,  # type: ignore[misc]
                )  # fmt: skip
    other: tuple[tuple[str, str, str, Changed], ...] = (
        (
            "frame",
            "the tensor of {who} is taken in its principal axes as if they were the link axes",
            axes,
            lambda x, k: {"tensors": np.diag(np.linalg.eigvalsh(x.tensors[k]))},
        ),
        (
            "inertial_parameters",
            "the products of inertia of {who} are left out",
            "use the full tensor",
            lambda x, k: {"tensors": np.diag(np.diag(x.tensors[k]))},
        ),
        (
            "inertial_parameters",
            "the center of mass of {who} is taken at the link origin",
            "use the center of mass in the link frame",
            lambda x, k: {"centers": np.zeros(3)},
        ),
        *(
            (
                "inertia_point",
                message,
                TENSOR_POINT_REMEDY,
                lambda x, k, f=factor: {"tensors": x.tensors[k] + f * _steiner(x, k)},
            )
            for factor, message in TENSOR_POINT_MESSAGES.items()
        ),
        *(
            (
                "inertial_parameters",
                f"the tensor of {{who}} is read in the order {names}",
                f"URDF writes {', '.join(TENSOR_NAMES)}",
                lambda x, k, places=places: {"tensors": _reordered(x.tensors[k], places)},
            )
            for names, written in OTHER_TENSOR_ORDERS.items()
            for places in (written, tuple(np.argsort(written)))
        ),
        *(
            (
                "inertial_parameters",
                f"{TENSOR_NAMES[i]} and {TENSOR_NAMES[j]} of {{who}} are exchanged",
                f"URDF writes {', '.join(TENSOR_NAMES)}",
                lambda x, k, places=places: {"tensors": _reordered(x.tensors[k], places)},
            )
            for i, j in itertools.combinations(range(6), 2)
            for places in [_exchanged(6, i, j)]
        ),
        *(
            (
                "inertial_parameters",
                f"the center of mass of {{who}} is read in the order {', '.join('xyz'[i] for i in order)}",
                "read x, y, z",
                lambda x, k, order=order: {"centers": x.centers[k][list(order)]},
            )
            for order in itertools.permutations(range(3))
            if order != (0, 1, 2)
        ),
    )
    for kind, message, remedy, change in other:
        yield from of_bodies(model, kind, message, remedy, change)
    for i, k in itertools.combinations(range(model.n_bodies), 2):
        order = _exchanged(model.n_bodies, i, k)
        yield CodeFault.of(
            "inertial_parameters",
            f"the inertial parameters of bodies '{model.body_names[i]}' and '{model.body_names[k]}' are exchanged",
            "assign them by name",
            lambda code, order=order: _assigned(code, order),  # type: ignore[misc]
        )


TENSOR_POINT_REMEDY = "a tensor about the center of mass needs m (c·c E - c cᵀ) more about the link origin"

TENSOR_POINT_MESSAGES = {
    -1.0: "the tensor of {who} is about the center of mass and used as if about the link origin",
    1.0: "the tensor of {who} is about the link origin and used as if about the center of mass",
    -2.0: "the parallel-axis term of {who} has the opposite sign",
}
"""Messages by what is wrongly added to the tensor about the center of mass, in parallel-axis terms."""


def _steiner(x: Numbers, k: int) -> Array:
    return parallel_axis(x.masses[k], x.centers[k])


def _turned(x: Numbers, k: int, rotation: Array, center: bool, tensor: bool) -> dict[str, Array]:
    found = {}
    if center:
        found["centers"] = rotation @ x.centers[k]
    if tensor:
        found["tensors"] = rotation @ x.tensors[k] @ rotation.T
    return found


def _reordered(tensor: Array, places: Sequence[int]) -> Array:
    """The tensor whose six numbers stand at other places: number i of it is number places[i] of this one."""
    other = np.empty((3, 3), tensor.dtype)
    for (i, k), place in zip(UPPER_TRIANGLE, places, strict=True):
        other[i, k] = other[k, i] = tensor[UPPER_TRIANGLE[place]]
    return other


def _exchanged(n: int, i: int, k: int) -> list[int]:
    order = list(range(n))
    order[i], order[k] = k, i
    return order


def _assigned(code: DynamicsCode, order: Sequence[int]) -> DynamicsCode:
    x = code.numbers
    return code.but(masses=x.masses[list(order)], centers=x.centers[list(order)], tensors=x.tensors[list(order)])


MASS, CENTER, TENSOR = slice(0, 1), slice(1, 4), slice(4, 10)
"""Places among the ten numbers of a body: m, c, J about the center of mass."""

PARAMETER_LABELS = ("m", "c_x", "c_y", "c_z", *TENSOR_NAMES)
BODY_NUMBER_UNITS = ("kg", *3 * ("m",), *6 * ("kg m²",))

PARAMETER_GROUPS = {(0,): "the mass", (1, 2, 3): "the center of mass", tuple(range(4, 10)): "the tensor"}
"""Numbers that belong together."""

MAX_LISTED_NUMBERS = 4
"""Numbers that a message lists at most; the diagnosis has all of them."""

PARAMETER_REMEDY = "compare mass, center of mass and tensor, and the fixed links that the body carries"


def parameters(model: RobotModel) -> Iterator[CodeFault]:
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


def _of_body(model: RobotModel, k: int, places: tuple[int, ...]) -> CodeFault:
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

    return CodeFault(np.zeros(len(which)), change, say)


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


def _factor(what: str, field: str, bodies: Array) -> CodeFault:
    def change(code: DynamicsCode, x: Array) -> DynamicsCode:
        array = getattr(code.numbers, field)
        return code.but(**{field: np.where(bodies.reshape(-1, *[1] * (array.ndim - 1)), x[0] * array, array)})

    return CodeFault(np.ones(1), change, lambda x: _scaled(what, x[0]), starts=np.array([[1.0], [1e3], [1e-3]]))


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
