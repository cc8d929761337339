"""Repairs that the caller asks for by name; everything else stays as the file says."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator

from lxml import etree

from urdf.document.elements import describe, line_said
from urdf.document.numbers import MIN_AXIS_LENGTH, MIN_UNLIMITED, UNIT_LENGTH_TOLERANCE, values
from urdf.document.source import Source
from urdf.errors import InvalidRepair, shortened
from urdf.reading.corrections import correct_inertials
from urdf.reading.mesh_inertials import InertialsFromMeshes, inertials_from_meshes

GEOMS = "geoms"
"""The repair that MuJoCo makes while it reads the file."""

RIGHT_ANGLE = math.pi / 2
MAX_TRUNCATION, EXACT_TOLERANCE = 2e-3, 1e-12
"""Differences from a multiple of π/2 [rad]: an angle between the two is a truncated multiple, such as 3.14 for π."""

FROM_MESHES = "inertials-from-meshes"
"""The name of the repair that has numbers."""

Repair = str | InertialsFromMeshes
"""A repair by its name, or one that has numbers."""


def repair(source: Source, wanted: Iterable[Repair]) -> list[str]:
    """Repair the elements of the source; return every change, in words. Raises InvalidRepair for unknown names.

    InertialsFromMeshes: links get inertials that are computed from their shapes
    "angles": truncated multiples of π/2 in rpy get all digits
    "axis": axes get unit length
    "geoms": bodies of an MJCF file without <inertial> have got that of their geoms (open_document, uses_geoms)
    "limits": lower and upper limits of position that are reversed are exchanged
    "inertials": inertials that cannot be right, and that one change alone makes right, are corrected
    """
    if isinstance(wanted, Repair):
        raise InvalidRepair(f"repair is {_said(wanted)}", f"give a tuple: ({wanted!r},)", path=source.path)
    wanted = tuple(wanted)
    names = [one for one in wanted if not isinstance(one, InertialsFromMeshes)]
    unknown = [name for name in names if name not in REPAIRS]
    if FROM_MESHES in unknown:
        remedy = f"give urdf.InertialsFromMeshes(density=…) or (total_mass=…); --repair {FROM_MESHES}=1000 or =20kg"
        raise InvalidRepair(f"'{FROM_MESHES}' needs a density or a total mass", remedy, path=source.path)
    if unknown:
        known = ", ".join((*REPAIRS, "urdf.InertialsFromMeshes(density=1000) (--repair inertials-from-meshes=1000)"))
        raise InvalidRepair(f"no repair is called {unknown[0]!r}", f"known: {known}", path=source.path)
    changes = [change for name in REPAIRS if name in names for change in REPAIRS[name](source)]
    for one in wanted:
        if isinstance(one, InertialsFromMeshes):
            changes += inertials_from_meshes(source, one)
    return changes


def uses_geoms(wanted: Iterable[Repair]) -> bool:
    """Whether inertials are to be computed from the geoms of an MJCF file."""
    return not isinstance(wanted, Repair) and GEOMS in tuple(wanted)


def _said(wanted: Repair) -> str:
    return f"the string '{wanted}'" if isinstance(wanted, str) else f"one {type(wanted).__name__}"


def crossed_limits(joint: etree._Element) -> tuple[float, float] | None:
    """Lower and upper limit of position where they are reversed; None where they are in order, infinite or missing."""
    limit = joint.find("limit")
    lower, upper = values(limit, "lower", 1), values(limit, "upper", 1)
    if joint.get("type") not in ("revolute", "prismatic") or lower is None or upper is None:
        return None
    finite = abs(lower[0]) < MIN_UNLIMITED and abs(upper[0]) < MIN_UNLIMITED
    return (lower[0], upper[0]) if finite and lower[0] > upper[0] else None


def is_truncated(angle: float) -> bool:
    """Whether an angle [rad] is a multiple of π/2, up to a whole turn, written with few digits."""
    turns = round(angle / RIGHT_ANGLE)
    return turns != 0 and abs(turns) <= 4 and EXACT_TOLERANCE < abs(angle - RIGHT_ANGLE * turns) < MAX_TRUNCATION


def _angles(source: Source) -> Iterator[str]:
    for element in (*source.links, *source.joints):
        for origin in element.iter("origin"):
            words = (origin.get("rpy") or "").split()
            angles = values(origin, "rpy", 3) or []
            exact = [
                repr(RIGHT_ANGLE * round(angle / RIGHT_ANGLE)) if is_truncated(angle) else word
                for word, angle in zip(words, angles, strict=True)
            ]
            if exact != words[: len(exact)]:
                origin.set("rpy", " ".join(exact))
                yield f"{line_said(origin)}: {describe(origin)}: rpy {' '.join(words)} made {' '.join(exact)}"


def _axes(source: Source) -> Iterator[str]:
    for joint in source.joints:
        element = joint.find("axis")
        axis = values(element, "xyz", 3)
        if element is None or axis is None:
            continue
        length = math.hypot(*axis)
        if abs(length - 1) > UNIT_LENGTH_TOLERANCE and length > MIN_AXIS_LENGTH:
            new = " ".join(repr(x / length) for x in axis)
            said = f"xyz {' '.join(str(element.get('xyz')).split())} made {new}"
            element.set("xyz", new)
            yield f"{line_said(element)}: {describe(element)}: {said}, of length 1"


def _geoms(source: Source) -> Iterator[str]:
    if source.from_geoms is None:
        problem, remedy = (
            f"'{GEOMS}' is for MJCF files",
            f"give urdf.InertialsFromMeshes(density=1000) (--repair {FROM_MESHES}=1000)",
        )
        raise InvalidRepair(problem, remedy, path=source.path)
    for name in source.from_geoms:
        yield f"body '{shortened(name)}': inertial computed from its geoms"


def _limits(source: Source) -> Iterator[str]:
    for joint in source.joints:
        crossed, limit = crossed_limits(joint), joint.find("limit")
        if crossed is not None and limit is not None:
            lower, upper = limit.get("lower", ""), limit.get("upper", "")
            limit.set("lower", upper)
            limit.set("upper", lower)
            yield f"{line_said(limit)}: {describe(limit)}: lower {lower} and upper {upper} exchanged"


REPAIRS: dict[str, Callable[[Source], Iterator[str]]] = {
    "angles": _angles,
    "axis": _axes,
    GEOMS: _geoms,
    "inertials": correct_inertials,
    "limits": _limits,
}
"""The repairs, by the names that urdf.load takes."""
