"""What shows when the files of a folder are laid beside one another: densities of CAD, and copied inertials."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path

import numpy as np

from graphdyn.errors import counted
from graphdyn.layout import Array
from urdf.document.numbers import values
from urdf.document.opening import open_document
from urdf.document.source import reduced
from urdf.errors import URDFError
from urdf.inspection.findings import Finding, Inspection, about, report
from urdf.inspection.structure import LinkInertial, Structure
from urdf.reading.corrections import DENSITIES

MATERIALS = {
    **DENSITIES,
    10.0: "a power of ten",
    100.0: "a power of ten",
    1000.0: "a power of ten, or kg in place of g",
}
"""Ratios of the masses of one body that come from the density of its material in CAD, or from another unit."""

SAME_RATIO, SAME_BODY = 0.01, 0.01
"""Relative differences up to which a ratio is one of these, and center of mass and tensor over mass are of one body; a
maker's arm that was drawn twice differs by 0.5 %."""

OTHER_REACH = 0.01
"""Relative difference of the distance of the next joint from which two links are not one part."""


@dataclass(frozen=True, eq=False)
class FolderLink:
    """A moving link with mass, in one of the files.

    file: its number
    form: center of mass [m], and tensor over mass [m²] in link axes, its upper triangle    (9,)
    reach: distance of the next joint, where there is one [m]
    """

    file: int
    inertial: LinkInertial
    form: Array
    reach: float | None


def compared(inspections: Sequence[Inspection]) -> list[Inspection]:
    """The inspections of several files, with what shows when they are laid beside one another; in their order."""
    if len(inspections) < 2:
        return list(inspections)
    names = [Path(each.robot).name for each in inspections]
    further: list[list[Finding]] = [[] for _ in inspections]
    with np.errstate(all="ignore"):  # numbers may be as large as the largest double
        parts = [list(_parts(k, each)) for k, each in enumerate(inspections)]
        for finding, file in chain(_densities(parts, names), _copies(parts, names)):
            further[file].append(finding)
    return [
        report(each.robot, each.path, [*each.findings, *found]) if found else each
        for each, found in zip(inspections, further, strict=True)
    ]


def _parts(file: int, inspected: Inspection) -> Iterator[FolderLink]:
    if inspected.path is None or inspected.verdict == "refused":
        return
    try:
        structure = Structure.of(reduced(open_document(Path(inspected.path), None)))
    except (URDFError, OSError):  # a file that changes under our hands
        return
    for each in structure.inertials:
        if structure.moving(each.link) and each.mass > 0 and each.size > 0:
            form = np.concatenate([each.center, each.turned[np.triu_indices(3)] / each.mass])
            onwards = [values(joint.find("origin"), "xyz", 3) for joint in structure.joints_from.get(each.link, ())]
            places = [place for place in onwards if place is not None]
            yield FolderLink(file, each, form, float(np.linalg.norm(places[0])) if len(places) == 1 else None)


def _densities(parts: Sequence[Sequence[FolderLink]], names: Sequence[str]) -> Iterator[tuple[Finding, int]]:
    """Files that have the links of another one with the mass of another material."""
    by_name: dict[str, list[FolderLink]] = {}
    for part in chain(*parts):
        by_name.setdefault(part.inertial.link, []).append(part)
    pairs: dict[tuple[int, int, float], list[tuple[FolderLink, FolderLink]]] = {}
    for alike in by_name.values():
        masses = np.array([part.inertial.mass for part in alike])
        for ratio in MATERIALS:
            found = np.abs(masses[:, None] / masses / ratio - 1) < SAME_RATIO
            for heavy, light in zip(*np.nonzero(found), strict=True):
                if _one_body(alike[heavy], alike[light]):
                    one, other = alike[heavy], alike[light]
                    pairs.setdefault((one.file, other.file, ratio), []).append((one, other))
    told = set[int]()
    for (heavy, light, ratio), links in sorted(pairs.items(), key=lambda pair: -len(pair[1])):
        one, other = max(links, key=lambda link: link[0].inertial.mass)
        for part, beside, file in ((one, other, heavy), (other, one, light)):
            if file not in told:
                told.add(file)
                yield (
                    about(
                        "other-density",
                        part.inertial.element,
                        f"{part.inertial.mass:.4g} kg, where this link of {names[beside.file]} has "
                        f"{beside.inertial.mass:.4g} kg with the same center of mass and tensor over mass: in "
                        f"{counted(len(links), 'link')} a ratio of {ratio:.3g}, {MATERIALS[ratio]} or the other way "
                        "round",
                    ),
                    file,
                )


def _one_body(one: FolderLink, other: FolderLink) -> bool:
    """Whether center of mass and tensor over mass are the same."""
    center, tensor = one.form[:3] - other.form[:3], one.form[3:] - other.form[3:]
    scale = float(np.trace(one.inertial.tensor)) / one.inertial.mass  # the square of a length
    size = max(float(np.linalg.norm(one.form[:3])), np.sqrt(scale))
    return bool(np.linalg.norm(center) < SAME_BODY * size and np.linalg.norm(tensor) < SAME_BODY * scale)


def _copies(parts: Sequence[Sequence[FolderLink]], names: Sequence[str]) -> Iterator[tuple[Finding, int]]:
    """Files that have the inertials of another one on links of another length."""
    by_inertial: dict[tuple[str, float, bytes], list[FolderLink]] = {}
    for part in chain(*parts):
        by_inertial.setdefault((part.inertial.link, part.inertial.mass, part.form.tobytes()), []).append(part)
    copies: dict[int, list[tuple[FolderLink, FolderLink]]] = {}
    for alike in by_inertial.values():
        for part in alike:
            other = next((each for each in alike if each.file != part.file and _longer(part, each)), None)
            if other is not None:
                copies.setdefault(part.file, []).append((part, other))
    for file, links in copies.items():
        part, other = links[0]
        more = f"; so are {len(links) - 1} more" if len(links) > 1 else ""
        yield (
            about(
                "equal-inertials",
                part.inertial.element,
                f"the inertial of this link of {names[other.file]}, where the next joint is "
                f"{other.reach:.4g} m away, here {part.reach:.4g} m{more}",
            ),
            file,
        )


def _longer(one: FolderLink, other: FolderLink) -> bool:
    """Whether the next joints are at other distances."""
    if one.reach is None or other.reach is None:
        return False
    return abs(one.reach - other.reach) > OTHER_REACH * max(one.reach, other.reach)
