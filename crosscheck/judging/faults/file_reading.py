"""Faults in reading a URDF file: inertial frames, links without mass, fixed links, rounded numbers."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from crosscheck.judging.faults.fault import CodeFault, named, rotation_from
from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.reference.subject import Subject
from graphdyn.layout import Array
from urdf.document import rpy_from_rotation
from urdf.reading import Misreadings

if TYPE_CHECKING:
    from yourdfpy.urdf import Joint, Link, Robot

MAX_DROPPED_LINKS = 5
"""Largest number of fixed links of which every subset is left out; beyond, one, two and all."""

Change = Callable[["Robot"], object]


_known: dict[tuple[str, str | None, str], list[CodeFault]] = {}


def faults_of_file(robot: Subject) -> Sequence[CodeFault]:
    """Faults in reading the file of a robot, none where it has no file.

    They are kept for each file and reading: one process often judges several functions of one robot.
    """
    if robot.file is None:
        return ()
    key = robot.file, robot.file_sha256, repr(robot.reading)
    if key not in _known:
        _known[key] = list(file_reading(Misreadings(robot.file, robot.reading)))
    return _known[key]


def file_reading(readings: Misreadings) -> Iterator[CodeFault]:
    """Every misreading that changes a number of the recursion."""
    told = {what: (kind, remedy, change) for what, kind, remedy, change in _changes(readings)}
    changes = {what: change for what, (_, _, change) in told.items()}
    (right,) = readings.of({"": lambda robot: None})
    for what, bodies, joints in readings.of(changes):
        kind, remedy, _ = told[what]
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
            yield CodeFault.of(kind, what, remedy, lambda code, replaced=replaced: _replaced(code, replaced))  # type: ignore[misc]


_FIELDS: dict[str, Callable[..., Array]] = {
    "rotations": lambda pair: pair[1].placement.rotation,
    "translations": lambda pair: pair[1].placement.translation,
    "masses": lambda pair: pair[0].mass,
    "centers": lambda pair: pair[0].center_of_mass,
    "tensors": lambda pair: pair[0].inertia,
}


def _replaced(code: DynamicsCode, replaced: dict[str, tuple[list[int], Array]]) -> DynamicsCode:
    arrays = {}
    for name, (members, entries) in replaced.items():
        arrays[name] = np.array(getattr(code.numbers, name))
        arrays[name][members] = entries
    return code.but(**arrays)


def _changes(readings: Misreadings) -> Iterator[tuple[str, str, str, Change]]:
    """Message, kind, remedy and change."""
    robot = readings.robot
    yield from _inertial_frames(robot)
    yield from _massless(robot)
    yield from _fixed_links(readings)
    yield from _rounded(robot)


def _inertial_frames(robot: Robot) -> Iterator[tuple[str, str, str, Change]]:
    placed = {
        x.name: x.inertial.origin for x in robot.links if x.inertial is not None and x.inertial.origin is not None
    }
    sets = [[name] for name in placed] + ([list(placed)] if len(placed) > 1 else [])
    remedy = "an inertial frame has a place and axes: c = xyz, and the tensor in link axes is R J Rᵀ"
    for names in sets:
        of = f"inertial frame of {named('link', names)}" if len(names) == 1 else "inertial frames of all links"
        changes: tuple[tuple[str, Callable[[Array], Array]], ...] = (
            (f"the rpy of the {of} is ignored", lambda origin: _placement(np.eye(3), origin[:3, 3])),
            (f"the rotation of the {of} is transposed", lambda origin: _placement(origin[:3, :3].T, origin[:3, 3])),
            (f"the origin of the {of}, xyz and rpy, is ignored", lambda _: np.eye(4)),
            (f"the xyz of the {of} is ignored", lambda origin: _placement(origin[:3, :3], np.zeros(3))),
            (
                f"the xyz of the {of} is taken in the axes of that frame",
                lambda origin: _placement(origin[:3, :3], origin[:3, :3] @ origin[:3, 3]),
            ),
        )
        for said, change in changes:
            if any(not np.array_equal(change(origin), origin) for name, origin in placed.items() if name in names):
                yield said, "inertial_frame", remedy, lambda r, n=names, c=change: _origins(r, n, c)  # type: ignore[misc]


def _origins(robot: Robot, names: list[str], change: Callable[[Array], Array]) -> None:
    for link in robot.links:
        if link.name in names:
            link.inertial.origin = change(link.inertial.origin)


def _placement(rotation: Array, translation: Array) -> Array:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, translation
    return matrix


def _massless(robot: Robot) -> Iterator[tuple[str, str, str, Change]]:
    if all(link.inertial is not None for link in robot.links):
        return
    remedy = "a link without <inertial> has no mass; some readers give it one"
    for tensor in (1.0, 0.0):
        said = f"links without <inertial> weigh 1 kg{' and have 1 kg m²' if tensor else ''}"

        def change(r: Robot, tensor: float = tensor) -> None:
            from yourdfpy.urdf import Inertial  # takes a second

            for link in r.links:
                if link.inertial is None:
                    link.inertial = Inertial(mass=1.0, inertia=tensor * np.eye(3), origin=np.eye(4))

        yield said, "massless_link", remedy, change


def _fixed_links(readings: Misreadings) -> Iterator[tuple[str, str, str, Change]]:
    heavy, robot = tuple(readings.carriers), readings.robot
    sizes = range(1, len(heavy) + 1) if len(heavy) <= MAX_DROPPED_LINKS else (1, 2, len(heavy))
    for names in itertools.chain.from_iterable(itertools.combinations(heavy, size) for size in sizes):
        yield (
            f"the mass of {named('fixed link', names)} is left out",
            "fixed_link",
            f"add mass, first moment and inertia to {_listed(readings.carriers[x] for x in names)}, which carries it",
            lambda r, n=names: _without_mass(r, n),  # type: ignore[misc]
        )
    joints = [joint for joint in robot.joints if joint.type == "fixed"]
    place = "a fixed joint has a placement like every other"
    for joint in joints:
        misplaced: tuple[tuple[str, Callable[[Array], Array]], ...] = (
            ("placement", lambda _: np.eye(4)),
            ("rotation", lambda origin: _placement(np.eye(3), origin[:3, 3])),
            ("translation", lambda origin: _placement(origin[:3, :3], np.zeros(3))),
        )
        for said, change in misplaced:
            yield (
                f"the {said} of fixed joint '{joint.name}' is left out",
                "fixed_link",
                place,
                lambda r, n=joint.name, c=change: _moved(r, n, c),  # type: ignore[misc]
            )
    for first, second in itertools.combinations(joints, 2):
        if first.parent == second.parent:
            yield (
                f"fixed link '{second.child}' is placed relative to its sibling '{first.child}'",
                "fixed_link",
                "siblings have one parent; each is placed relative to that",
                lambda r, n=second.name, p=first.child: _carried(r, n, p),  # type: ignore[misc]
            )


def _listed(names: Iterable[str]) -> str:
    return ", ".join(f"'{name}'" for name in dict.fromkeys(names))


def _without_mass(robot: Robot, names: tuple[str, ...]) -> None:
    for link in robot.links:
        if link.name in names:
            link.inertial = None


def _moved(robot: Robot, name: str, change: Callable[[Array], Array]) -> None:
    joint = _joint(robot, name)
    joint.origin = change(np.eye(4) if joint.origin is None else joint.origin)


def _carried(robot: Robot, name: str, parent: str) -> None:
    _joint(robot, name).parent = parent


def _joint(robot: Robot, name: str) -> Joint:
    return next(joint for joint in robot.joints if joint.name == name)


def _rounded(robot: Robot) -> Iterator[tuple[str, str, str, Change]]:
    remedy = "use all digits of the file"
    for digits in (2, 3, 4, 5, 6):
        for what, change in (
            ("rpy angles of the joints are", _rounded_rpy),
            ("masses are", _rounded_masses),
            ("centers of mass are", _rounded_centers),
            ("tensors are", _rounded_tensors),
            ("placements of the joints are", _rounded_places),
        ):
            example = " (1.57 for π/2)" if digits == 2 and "rpy" in what else ""
            yield (
                f"the {what} rounded to {digits} decimals{example}",
                "rounding",
                remedy,
                lambda r, c=change, d=digits: c(r, d),  # type: ignore[misc]
            )


def _rounded_rpy(robot: Robot, digits: int) -> None:
    for joint in robot.joints:
        if joint.origin is not None:
            rotation = rotation_from(np.round(rpy_from_rotation(joint.origin[:3, :3]), digits))
            joint.origin = _placement(rotation, joint.origin[:3, 3])


def _rounded_places(robot: Robot, digits: int) -> None:
    for joint in robot.joints:
        if joint.origin is not None:
            joint.origin = _placement(joint.origin[:3, :3], np.round(joint.origin[:3, 3], digits))


def _rounded_masses(robot: Robot, digits: int) -> None:
    for link in _with_inertial(robot):
        link.inertial.mass = round(link.inertial.mass, digits)


def _rounded_centers(robot: Robot, digits: int) -> None:
    for link in _with_inertial(robot):
        if link.inertial.origin is not None:
            origin = link.inertial.origin
            link.inertial.origin = _placement(origin[:3, :3], np.round(origin[:3, 3], digits))


def _rounded_tensors(robot: Robot, digits: int) -> None:
    for link in _with_inertial(robot):
        link.inertial.inertia = np.round(link.inertial.inertia, digits)


def _with_inertial(robot: Robot) -> list[Link]:
    return [link for link in robot.links if link.inertial is not None]
