"""Wrong masses, centers of mass and tensors: axes, points, entries, exchanged bodies."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from crosscheck.judging.faults.changes import E1, E2, E3, Changed, of_bodies
from crosscheck.judging.faults.fault import CodeFault
from crosscheck.judging.faults.recursion import DynamicsCode, Numbers
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
