"""Repairs into a copy of a URDF file: every byte that no repair concerns stays as it was."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from graphdyn.display import short_repr
from urdf.document.catalog import locate
from urdf.document.elements import name_of
from urdf.document.files import write_whole
from urdf.document.opening import open_document
from urdf.document.source import reduced
from urdf.errors import InvalidRepair
from urdf.reading.corrections import candidates
from urdf.reading.repairing import REPAIRS, Repair
from urdf.reading.repairing import repair as repair_elements
from urdf.writing.in_place import editable, inertial_spans, refuse_expanded, with_attributes, with_inertials

REPAIRED_CODES = {
    "axis-not-normalized": "axis",
    "limits-crossed": "limits",
    "rpy-truncated": "angles",
    **dict.fromkeys(
        (
            "center-outside-mesh",
            "effort-below-gravity",
            "effort-below-inertia",
            "far-center-of-mass",
            "gyration-radius",
            "heaviest-link",
            "heavy-link",
            "inconsistent-body",
            "indefinite-inertia",
            "inertia-unlike-mesh",
            "inertial-density",
            "mesh-density",
            "miswritten-inertia",
            "other-density",
            "suspicious-masses",
            "triangle-inequality",
            "unlike-twin",
        ),
        "inertials",
    ),
}
"""The repair by the code of the findings that it mends; findings about inertials only where one correction is sure."""


@dataclass(frozen=True)
@short_repr
class RepairedFile:
    """What urdf.repair did.

    path: of the copy; None where nothing was written
    changes: each with line, element, old and new value
    candidates: what could be repaired in several ways, and is left as it is
    """

    path: Path | None
    changes: tuple[str, ...]
    candidates: tuple[str, ...] = ()


def repair(
    source: str | PathLike[str], destination: str | PathLike[str] | None, take: Iterable[Repair]
) -> RepairedFile:
    """Write a copy of a URDF file with the repairs that are named; no other byte is changed.

    source: path, or name of the catalog; destination: may be the same path; None: only tell the changes
    take: repairs as in urdf.load (repair=), or codes of findings for them (REPAIRED_CODES): "limits-crossed" for
        "limits"

    Without a change nothing is written. Raises InvalidRepair for other names, CannotUpdate for .xacro files, UTF-16
    and the like; urdf.load's errors for a file that is no URDF; OSError.
    """
    wanted = [REPAIRED_CODES.get(one, one) if isinstance(one, str) else one for one in take]
    if not wanted:
        raise InvalidRepair("no repair is named", f"known: {', '.join((*REPAIRS, *REPAIRED_CODES))}")
    path, _ = locate(source)
    refuse_expanded(path)
    document = open_document(path, None)
    data = editable(path)
    elements = [element for element in document.robot.iter() if isinstance(element.tag, str)]
    before = [dict(element.attrib) for element in elements]
    robot = reduced(document)
    ambiguous = tuple(candidates(robot)) if "inertials" in wanted else ()
    changes = tuple(repair_elements(robot, wanted))
    if changes and destination is not None:
        attributes = {
            number: {str(key): str(value) for key, value in element.items() if old.get(key) != value}
            for number, (element, old) in enumerate(zip(elements, before, strict=True))
        }
        data = with_attributes(data, {number: new for number, new in attributes.items() if new})
        spans, known = inertial_spans(data), set(elements)
        inertials = [(link, link.find("inertial")) for link in robot.links]
        new = [(spans[name_of(link)], found) for link, found in inertials if found is not None and found not in known]
        write_whole(Path(destination), with_inertials(data, new))
    return RepairedFile(Path(destination) if changes and destination is not None else None, changes, ambiguous)
