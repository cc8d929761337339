"""Faults in reading a URDF file: inertial frames, links without mass, fixed links, rounded numbers."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from crosscheck.judging.faults.fault import CodeFault, named, opposite_rotation_from, rotation_from
from crosscheck.judging.faults.link_parameters import PlacedInertial, links_of
from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.reference.subject import Subject
from graphdyn.layout import Array
from urdf.document import rpy_from_rotation
from urdf.reading import Misreadings

if TYPE_CHECKING:
    from yourdfpy.urdf import Joint, Robot

MAX_DROPPED_LINKS = 5
"""Largest number of fixed links of which every subset is left out; beyond, one, two and all."""

Misread = tuple[str, str, str, Callable[["Robot"], object]]
"""Kind, message, remedy and the change of the file's robot."""


@dataclass(frozen=True, eq=False)
class FileFaults:
    """Faults in reading the file of a robot, none where it has no file; and the inertials of its links."""

    faults: Sequence[CodeFault]
    links: Sequence[PlacedInertial]


ROUNDING_REMEDY = "use all digits of the file"

_known: dict[tuple[str, str | None, str], FileFaults] = {}


def faults_of_file(robot: Subject) -> FileFaults:
    """They are kept for each file and reading: one process often judges several functions of one robot."""
    if robot.file is None:
        return FileFaults((), links_of(robot.model, None))
    key = robot.file, robot.file_sha256, repr(robot.reading)
    if key not in _known:
        readings = Misreadings(robot.file, robot.reading)
        _known[key] = FileFaults(list(file_reading(readings)), links_of(robot.model, readings))
    return _known[key]


def file_reading(readings: Misreadings) -> Iterator[CodeFault]:
    """Every misreading that changes a number of the recursion."""
    told = {
        message: (kind, remedy, change, size)
        for size, mistakes in enumerate((_misread(readings), _rounded_pairs()), start=1)
        for kind, message, remedy, change in mistakes
    }
    (right,) = readings.of({"": lambda robot: None})
    for message, bodies, joints in readings.of({message: change for message, (_, _, change, _) in told.items()}):
        kind, remedy, _, size = told[message]
        if tuple(joint.name for joint in joints) != tuple(joint.name for joint in right[2]):
            continue
        replaced = {}
        for name, read in _FIELDS.items():
            theirs, ours = (
                np.array([read(x) for x in zip(*pair, strict=True)]) for pair in ((bodies, joints), right[1:])
            )
            different = [k for k in range(len(ours)) if not np.array_equal(theirs[k], ours[k])]
            if different:
                replaced[name] = different, theirs[different]
        if replaced:
            yield CodeFault.of(kind, message, remedy, partial(_replaced, replaced), size)


_FIELDS: dict[str, Callable[..., Array]] = {
    "rotations": lambda pair: pair[1].placement.rotation,
    "translations": lambda pair: pair[1].placement.translation,
    "masses": lambda pair: pair[0].mass,
    "centers": lambda pair: pair[0].center_of_mass,
    "tensors": lambda pair: pair[0].inertia,
}


def _replaced(replaced: dict[str, tuple[list[int], Array]], code: DynamicsCode) -> DynamicsCode:
    arrays = {}
    for name, (members, entries) in replaced.items():
        arrays[name] = np.array(getattr(code.numbers, name))
        arrays[name][members] = entries
    return code.but(**arrays)


def _misread(readings: Misreadings) -> Iterator[Misread]:
    robot = readings.robot
    yield from _inertial_frames(robot)
    if any(link.inertial is None for link in robot.links):
        remedy = "a link without <inertial> has no mass; some readers give it one"
        for tensor, said in ((1.0, " and have 1 kg m²"), (0.0, "")):
            message = f"links without <inertial> weigh 1 kg{said}"
            yield "massless_link", message, remedy, partial(_with_inertials, tensor)
    yield from _fixed_links(readings)
    elements = {"joints and inertial frames": (True, True), "inertial frames": (False, True)}
    if readings.carriers:
        elements["joints, fixed ones too,"] = True, False
    for who, of in elements.items():
        message = f"the rpy angles of all {who} are applied in the opposite order"
        change = partial(_in_opposite_order, *of)
        yield "frame", message, "R = R_z(yaw) R_y(pitch) R_x(roll)", change
    for digits, (what, rounding) in itertools.product(ROUNDED_DIGITS, _ROUNDED.items()):
        example = " (1.57 for π/2)" if digits == 2 and "rpy" in what else ""
        message = f"the {what} are rounded to {digits} decimals{example}"
        yield "rounding", message, ROUNDING_REMEDY, partial(_rounded, rounding, digits)


def _rounded_pairs() -> Iterator[Misread]:
    """Centers and tensors at once."""
    centers, tensors = (_ROUNDED[what] for what in ("centers of mass", "tensors"))
    for of_centers, of_tensors in itertools.product(ROUNDED_DIGITS, repeat=2):
        message = (
            f"the centers of mass are rounded to {of_centers} decimals, and the tensors are rounded to {of_tensors}"
        )
        yield "rounding", message, ROUNDING_REMEDY, partial(_rounded_both, (centers, of_centers), (tensors, of_tensors))


def _inertial_frames(robot: Robot) -> Iterator[Misread]:
    placed = {
        x.name: x.inertial.origin for x in robot.links if x.inertial is not None and x.inertial.origin is not None
    }
    sets = [[name] for name in placed] + ([list(placed)] if len(placed) > 1 else [])
    remedy = "an inertial frame has a place and axes: c = xyz, and the tensor in link axes is R J Rᵀ"
    for names in sets:
        of = f"inertial frame of {named('link', names)}" if len(names) == 1 else "inertial frames of all links"
        changes: dict[str, Callable[[Array], Array]] = {
            f"the rpy of the {of} is ignored": lambda origin: _placement(np.eye(3), origin[:3, 3]),
            f"the rotation of the {of} is transposed": lambda origin: _placement(origin[:3, :3].T, origin[:3, 3]),
            f"the origin of the {of}, xyz and rpy, is ignored": lambda _: np.eye(4),
            f"the xyz of the {of} is ignored": lambda origin: _placement(origin[:3, :3], np.zeros(3)),
            f"the xyz of the {of} is taken in the axes of that frame": lambda origin: _placement(
                origin[:3, :3], origin[:3, :3] @ origin[:3, 3]
            ),
        }
        for message, change in changes.items():
            if any(not np.array_equal(change(placed[name]), placed[name]) for name in names):
                yield "inertial_frame", message, remedy, partial(_origins, names, change)


def _origins(names: list[str], change: Callable[[Array], Array], robot: Robot) -> None:
    for link in robot.links:
        if link.name in names:
            link.inertial.origin = change(link.inertial.origin)


def _placement(rotation: Array, translation: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, translation
    return matrix


def _with_inertials(tensor: float, robot: Robot) -> None:
    from yourdfpy.urdf import Inertial  # takes a second

    for link in robot.links:
        if link.inertial is None:
            link.inertial = Inertial(mass=1.0, inertia=tensor * np.eye(3), origin=np.eye(4))


def _in_opposite_order(joints: bool, inertials: bool, robot: Robot) -> None:
    elements: list[Any] = [*(robot.joints if joints else ()), *(x.inertial for x in robot.links if inertials)]
    for element in elements:
        if element is not None and element.origin is not None:
            rotation = opposite_rotation_from(rpy_from_rotation(element.origin[:3, :3]))
            element.origin = _placement(rotation, element.origin[:3, 3])


def _fixed_links(readings: Misreadings) -> Iterator[Misread]:
    heavy = tuple(readings.carriers)
    sizes = range(1, len(heavy) + 1) if len(heavy) <= MAX_DROPPED_LINKS else (1, 2, len(heavy))
    for names in itertools.chain.from_iterable(itertools.combinations(heavy, size) for size in sizes):
        carriers = ", ".join(f"'{name}'" for name in dict.fromkeys(readings.carriers[x] for x in names))
        message = f"the mass of {named('fixed link', names)} is left out"
        remedy = f"add mass, first moment and inertia to {carriers}, which carries it"
        yield "fixed_link", message, remedy, partial(_without_mass, names)
    joints = [joint for joint in readings.robot.joints if joint.type == "fixed"]
    misplaced: dict[str, Callable[[Array], Array]] = {
        "placement": lambda _: np.eye(4),
        "rotation": lambda origin: _placement(np.eye(3), origin[:3, 3]),
        "translation": lambda origin: _placement(origin[:3, :3], np.zeros(3)),
    }
    for joint, (what, change) in itertools.product(joints, misplaced.items()):
        message = f"the {what} of fixed joint '{joint.name}' is left out"
        yield (
            "fixed_link",
            message,
            "a fixed joint has a placement like every other",
            partial(_moved, joint.name, change),
        )
    for first, second in itertools.combinations(joints, 2):
        if first.parent == second.parent:
            message = f"fixed link '{second.child}' is placed relative to its sibling '{first.child}'"
            remedy = "siblings have one parent; each is placed relative to that"
            yield "fixed_link", message, remedy, partial(_carried, second.name, first.child)


def _without_mass(names: tuple[str, ...], robot: Robot) -> None:
    for link in robot.links:
        if link.name in names:
            link.inertial = None


def _moved(name: str, change: Callable[[Array], Array], robot: Robot) -> None:
    joint = _joint(robot, name)
    joint.origin = change(np.eye(4) if joint.origin is None else joint.origin)


def _joint(robot: Robot, name: str) -> Joint:
    return next(joint for joint in robot.joints if joint.name == name)


def _carried(name: str, parent: str, robot: Robot) -> None:
    _joint(robot, name).parent = parent


def _rounded_rpy(origin: Array, digits: int) -> Array:
    return _placement(rotation_from(np.round(rpy_from_rotation(origin[:3, :3]), digits)), origin[:3, 3])


def _rounded_place(origin: Array, digits: int) -> Array:
    return _placement(origin[:3, :3], np.round(origin[:3, 3], digits))


Rounding = tuple[str, str, Callable[[Any, int], Any]]
"""What is rounded: of which elements, which attribute, and how, to a number of digits."""

_ROUNDED: dict[str, Rounding] = {
    "rpy angles of the joints": ("joints", "origin", _rounded_rpy),
    "masses": ("inertials", "mass", round),
    "centers of mass": ("inertials", "origin", _rounded_place),
    "tensors": ("inertials", "inertia", np.round),
    "placements of the joints": ("joints", "origin", _rounded_place),
}

ROUNDED_DIGITS = (2, 3, 4, 5, 6)
"""Numbers of decimals to which people write numbers."""


def _rounded_both(first: tuple[Rounding, int], second: tuple[Rounding, int], robot: Robot) -> None:
    for what, digits in (first, second):
        _rounded(what, digits, robot)


def _rounded(what: Rounding, digits: int, robot: Robot) -> None:
    elements, attribute, rounding = what
    for element in robot.joints if elements == "joints" else [link.inertial for link in robot.links]:
        value = getattr(element, attribute, None)
        if value is not None:
            setattr(element, attribute, rounding(value, digits))
