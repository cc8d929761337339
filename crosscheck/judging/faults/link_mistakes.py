"""Mistakes in the inertial parameters of links, each of which may be made at one link, at some, or at all of them.

Torques are linear in mass, first moment and tensor about the link origin, of links as of bodies. So whether a mistake
was made, and at which links, is a linear question: each link adds its own difference of parameters.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from crosscheck.judging.faults.fault import opposite_rotation_from
from crosscheck.judging.faults.inertials import (
    OTHER_TENSOR_ORDERS,
    TENSOR_NAMES,
    TENSOR_POINT_MESSAGES,
    reordered_tensor,
)
from crosscheck.judging.faults.link_parameters import (
    Parameters,
    PlacedInertial,
    about_origin,
    bodies_of,
    in_body,
    right,
)
from crosscheck.judging.faults.recursion import DynamicsCode
from graphdyn.layout import Array
from graphdyn.model import parallel_axis
from urdf.document import rpy_from_rotation

Mistake = Callable[[PlacedInertial], Parameters]


@dataclass(frozen=True, eq=False)
class LinkMistake:
    """One mistake that may be made at every link, with {who} in its message."""

    kind: str
    message: str
    remedy: str
    of: Mistake

    def differences(self, links: Sequence[PlacedInertial]) -> Array:
        """What each link adds to the parameters of its body (L, 13)."""
        return np.array([in_body(link, self.of(link)) - in_body(link, right(link)) for link in links])


SHIFTED_PARTS = {
    "inertial parameters": ("mass", "center", "axes", "tensor"),
    "masses": ("mass",),
    "centers of mass": ("center",),
    "tensors": ("axes", "tensor"),
}
"""What may be that of another link, in words, and the fields."""


def shifted(links: Sequence[PlacedInertial], code: DynamicsCode) -> Iterator[tuple[str, list[tuple[int, Array]]]]:
    """Shifts of the numbers of links, and of bodies where these are others: in words, and the differences (13,) of the
    parameters of bodies, by their numbers."""
    bodies = bodies_of(code)
    for what, members in {"link": links, **({"body": bodies} if len(bodies) != len(links) else {})}.items():
        for message, differences in shifted_links(members):
            said = message if what == "link" else message.replace("every link", "every body").replace("links", "bodies")
            yield said, [(link.body, x) for link, x in zip(members, differences, strict=True)]


def shifted_links(links: Sequence[PlacedInertial]) -> Iterator[tuple[str, Array]]:
    """Numbers of each link that are those of its neighbors, or of the links in the opposite order; as differences of
    the parameters of its body (L, 13)."""
    n = len(links)
    places = {
        "of every link are those of the next one, of the last one those of the first": [*range(1, n), 0],
        "of every link are those of the one before, of the first one those of the last": [n - 1, *range(n - 1)],
        "of the links are in the opposite order": list(range(n))[::-1],
    }
    missing: dict[str, list[int | None]] = {
        "of every link are those of the next one, the last one has none": [*range(1, n), None],
        "of every link are those of the one before, the first one has none": [None, *range(n - 1)],
    }
    whole = "inertial parameters"
    shifts = [*itertools.product(SHIFTED_PARTS, places.items()), *((whole, shift) for shift in missing.items())]
    own = np.array([in_body(link, right(link)) for link in links])
    for what, (message, order) in shifts:
        taken = np.zeros_like(own)
        for k, (link, place) in enumerate(zip(links, order, strict=True)):
            if place is not None:
                other = replace(link, **{name: getattr(links[place], name) for name in SHIFTED_PARTS[what]})
                taken[k] = in_body(other, right(other))
        yield f"the {what} {message}", taken - own


LINK_REMEDY = "compare the numbers of each link with the file: mass, center of mass, tensor about it, and its axes"


def mistakes() -> Iterator[LinkMistake]:
    """Every mistake that is known here."""
    yield from _of_tensors()
    yield from _of_points()
    yield from _of_centers()
    yield from _of_frames()
    yield LinkMistake(
        "inertial_parameters",
        "the mass of {who} is 1 kg and the tensor a unit matrix about the link origin, whatever the file says",
        LINK_REMEDY,
        lambda x: (1.0, np.zeros(3), np.eye(3)),
    )
    yield _with_mass("the mass of {who} is 1 kg, whatever the file says", 1.0)
    yield _with_mass("the mass of {who} is left out", 0.0)
    yield LinkMistake(
        "inertial_parameters",
        "mass and tensor of {who} are left out",
        LINK_REMEDY,
        lambda x: (0.0, np.zeros(3), np.zeros((3, 3))),
    )


def _with_mass(message: str, mass: float) -> LinkMistake:
    return LinkMistake(
        "inertial_parameters", message, LINK_REMEDY, lambda x: about_origin(mass, x.center, x.turned_tensor)
    )


def _of_tensors() -> Iterator[LinkMistake]:
    """Other tensors about the center of mass."""

    def other(
        message: str, change: Callable[[PlacedInertial], Array], kind: str = "inertial_parameters"
    ) -> LinkMistake:
        return LinkMistake(kind, message, LINK_REMEDY, lambda x: about_origin(x.mass, x.center, change(x)))

    for axes, change_of in (
        ("in its inertial frame", _in_file),
        ("in link axes", _in_link),
    ):
        for size in (3, 1, 2):
            for places in itertools.combinations(((0, 1), (0, 2), (1, 2)), size):
                names = ", ".join(f"I_{'xyz'[i]}{'xyz'[j]}" for i, j in places)
                have = "have" if size > 1 else "has"
                what = f"the products of inertia of {{who}} {axes}" if size == 3 else f"{names} of {{who}} {axes}"
                yield other(
                    f"{what} {have} the opposite sign",
                    partial(change_of, partial(_scaled_entries, places, -1.0)),
                    "sign",
                )
                yield other(f"{what} are left out", partial(change_of, partial(_scaled_entries, places, 0.0)))
            for factor, scaled in ((0.5, "halved"), (2.0, "doubled")) if size == 3 else ():
                entries = partial(change_of, partial(_scaled_entries, ((0, 1), (0, 2), (1, 2)), factor))
                yield other(f"the products of inertia of {{who}} {axes} are {scaled}", entries)
        for i, j in itertools.combinations(range(6), 2):
            order = list(range(6))
            order[i], order[j] = j, i
            message = f"{TENSOR_NAMES[i]} and {TENSOR_NAMES[j]} of {{who}} {axes} are exchanged"
            yield other(message, partial(change_of, partial(reordered_tensor, order)))
        for names, written in OTHER_TENSOR_ORDERS.items():
            for order, way in ((list(written), "written"), (np.argsort(written).tolist(), "read")):
                message = f"the tensor of {{who}} {axes} is {way} in the order {names}"
                yield other(message, partial(change_of, partial(reordered_tensor, order)))
    for factor, said in (
        (0.0, "left out"),
        (2.0, "doubled"),
        (0.5, "halved"),
        (-1.0, "negated"),
        (1e-3, "multiplied by 1e-3"),
    ):
        yield other(f"the tensor of {{who}} is {said}", lambda x, factor=factor: factor * x.turned_tensor)  # type: ignore[misc]
    yield other("the tensor of {who} is divided by its mass", lambda x: x.turned_tensor / (x.mass or 1.0))
    yield other("the tensor of {who} is multiplied by its mass once more", lambda x: x.turned_tensor * x.mass)
    yield other("the tensor of {who} is a unit matrix, whatever the file says", lambda x: np.eye(3))
    one_side = "the inertial frame's rotation is applied on one side only"
    rotated: dict[str, Callable[[PlacedInertial], Array]] = {
        f"R J, not R J Rᵀ: {one_side}": lambda x: x.axes @ x.tensor,
        f"J Rᵀ, not R J Rᵀ: {one_side}": lambda x: x.tensor @ x.axes.T,
        f"Rᵀ J, not R J Rᵀ: {one_side}": lambda x: x.axes.T @ x.tensor,
        "R J R, not R J Rᵀ": lambda x: x.axes @ x.tensor @ x.axes,
        "not turned by the inertial frame's rotation": lambda x: x.tensor,
        "Rᵀ J R, turned by the inertial frame's rotation the wrong way": lambda x: x.axes.T @ x.tensor @ x.axes,
        "turned by the inertial frame's rpy in the opposite order": lambda x: (
            _again(x.axes) @ x.tensor @ _again(x.axes).T
        ),
    }
    for message, change in rotated.items():
        yield other(f"the tensor of {{who}} is {message}", change, "inertial_frame")


def _in_file(change: Callable[[Array], Array], link: PlacedInertial) -> Array:
    tensor: Array = link.axes @ change(link.tensor) @ link.axes.T
    return tensor


def _in_link(change: Callable[[Array], Array], link: PlacedInertial) -> Array:
    return change(link.turned_tensor)


def _scaled_entries(places: Sequence[tuple[int, int]], factor: float, tensor: Array) -> Array:
    found = np.array(tensor)
    for i, j in places:
        found[i, j] = found[j, i] = factor * tensor[i, j]
    return found


def _again(axes: Array) -> Array:
    """The rotation of the same roll, pitch and yaw in the opposite order."""
    return opposite_rotation_from(rpy_from_rotation(axes))


ADDED_TWICE = "the parallel-axis term of {who} is added where it must be subtracted, to get to the center of mass"


def _of_points() -> Iterator[LinkMistake]:
    """Tensors about another point than they are used for."""
    for factor, message in {**TENSOR_POINT_MESSAGES, 2.0: ADDED_TWICE}.items():
        yield LinkMistake("inertia_point", message, LINK_REMEDY, partial(_about_another_point, factor))


def _about_another_point(factor: float, x: PlacedInertial) -> Parameters:
    return about_origin(x.mass, x.center, x.turned_tensor + factor * parallel_axis(x.mass, x.center))


def _of_centers() -> Iterator[LinkMistake]:
    """Other centers of mass, the tensor about them unchanged; and first moments, the tensor about the origin
    unchanged."""
    diagonal = {
        f"{name} of the center of mass of {{who}} has the opposite sign": np.diag(signs)
        for name, signs in (("x", (-1.0, 1, 1)), ("y", (1, -1.0, 1)), ("z", (1, 1, -1.0)))
    }
    matrices: dict[str, Array] = {
        "the center of mass of {who} lies on the other side of the link origin": -np.eye(3),
        "the center of mass of {who} is taken at the link origin": np.zeros((3, 3)),
        **diagonal,
        "the center of mass of {who} is halved": np.eye(3) / 2,
        "the center of mass of {who} is doubled": 2 * np.eye(3),
        **{f"the center of mass of {{who}} is {unit}": factor * np.eye(3) for unit, factor in _UNITS.items()},
        **{
            f"the center of mass of {{who}} is read in the order {', '.join('xyz'[i] for i in order)}": np.eye(3)[
                list(order)
            ]
            for order in itertools.permutations(range(3))
            if order != (0, 1, 2)
        },
    }
    for message, matrix in matrices.items():
        yield _with_center(message, partial(_times_center, matrix))
        yield _with_moment(f"{message}, the tensor about the link origin is right", partial(_times_moment, matrix))
    yield _with_center("the center of mass of {who} is taken in the axes of the inertial frame", _turned_center)
    yield _with_center("the center of mass of {who} is turned the wrong way by its frame's rpy", _back_center)
    yield _with_moment("the center of mass of {who} is used as its first moment m c", lambda x: x.center)
    yield _with_moment("the first moment of {who} is multiplied by its mass twice", lambda x: x.mass**2 * x.center)
    yield LinkMistake(
        "inertial_parameters",
        "the center of mass of {who} is used as its first moment m c, and the tensor about it as that about the link "
        "origin",
        LINK_REMEDY,
        lambda x: (x.mass, x.center, x.turned_tensor),
    )


def _times_center(matrix: Array, link: PlacedInertial) -> Array:
    center: Array = matrix @ link.center
    return center


def _times_moment(matrix: Array, link: PlacedInertial) -> Array:
    moment: Array = link.mass * matrix @ link.center
    return moment


def _turned_center(link: PlacedInertial) -> Array:
    return _times_center(link.axes, link)


def _back_center(link: PlacedInertial) -> Array:
    return _times_center(link.axes.T, link)


_UNITS = {
    "divided by 1000, as meters taken as millimeters": 1e-3,
    "multiplied by 1000, as millimeters taken as meters": 1e3,
}


def _with_center(message: str, center: Callable[[PlacedInertial], Array]) -> LinkMistake:
    return LinkMistake(
        "inertial_parameters", message, LINK_REMEDY, lambda x: about_origin(x.mass, center(x), x.turned_tensor)
    )


def _with_moment(message: str, moment: Callable[[PlacedInertial], Array]) -> LinkMistake:
    return LinkMistake("inertial_parameters", message, LINK_REMEDY, lambda x: (x.mass, moment(x), right(x)[2]))


def _of_frames() -> Iterator[LinkMistake]:
    """Links that are fixed to another one, joined to it wrongly: in axes and about the point of their own link."""

    def joined(message: str, of: Mistake) -> LinkMistake:
        return LinkMistake("fixed_link", message, "a fixed joint has a placement like every other", of)

    def back(link: PlacedInertial, whole: Parameters) -> Parameters:
        """Parameters in link axes that give these in the body."""
        mass, moment, tensor = whole
        R, t = link.rotation, link.translation
        h = moment - mass * t
        about = tensor - parallel_axis(mass, t) - 2 * (h @ t) * np.eye(3) + np.outer(h, t) + np.outer(t, h)
        return mass, R.T @ h, R.T @ about @ R

    def placed(link: PlacedInertial) -> tuple[Array, Array]:
        return link.translation + link.rotation @ link.center, link.rotation @ link.turned_tensor @ link.rotation.T

    yield joined(
        "the tensor of {who} is not turned where it is joined to its body",
        lambda x: back(x, about_origin(x.mass, placed(x)[0], x.turned_tensor)),
    )
    yield joined(
        "the center of mass of {who} is not turned where it is joined to its body",
        lambda x: back(x, about_origin(x.mass, x.translation + x.center, placed(x)[1])),
    )
    yield joined(
        "center of mass and tensor of {who} are not turned where it is joined to its body",
        lambda x: back(x, about_origin(x.mass, x.translation + x.center, x.turned_tensor)),
    )
    yield joined(
        "{who} is not moved to its place where it is joined to its body",
        lambda x: back(x, about_origin(x.mass, x.rotation @ x.center, placed(x)[1])),
    )
    yield joined(
        "the tensor of {who} is joined to its body as if it were about the link origin",
        lambda x: back(x, (x.mass, x.mass * placed(x)[0], placed(x)[1] + parallel_axis(x.mass, x.translation))),
    )
    yield joined(
        "the parallel-axis term of {who} is left out where it is joined to its body",
        lambda x: back(x, (x.mass, x.mass * placed(x)[0], placed(x)[1])),
    )
