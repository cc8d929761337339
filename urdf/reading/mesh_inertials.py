"""A repair: inertials of links computed from their shapes, filled uniformly."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from math import isfinite
from typing import Literal

from lxml import etree

from graphdyn import Body
from urdf.document.elements import describe, line_of, line_said, name_of, tag_of
from urdf.document.numbers import inertial_element, values
from urdf.document.source import Source
from urdf.errors import InvalidRepair, listed
from urdf.geometry.mass_properties import FilledLink, filled_links


@dataclass(frozen=True)
class InertialsFromMeshes:
    """A repair for urdf.load: mass, center of mass and tensor of links from their shapes, filled uniformly.

    density: of all of them [kg/m³]; or total_mass: of all links of the file [kg], the root link included, from which
        the density follows; links that keep their <inertial> count with its mass
    links: "missing": those without <inertial>; "all"; or names

    The visual meshes, boxes, cylinders and spheres of a link are taken, or its collision shapes where it has no visual
    ones or one of them cannot be read. A mesh that is not closed is replaced by its convex hull. Shapes that overlap
    count twice. Real links are hollow, with heavy motors: the result is a guess of a plausible size.

    Raises InvalidRepair, when it is used, unless one of density and total_mass is given, finite and positive.
    """

    density: float | None = None
    total_mass: float | None = None
    links: Literal["missing", "all"] | Collection[str] = "missing"


def inertials_from_meshes(source: Source, wanted: InertialsFromMeshes) -> Iterator[str]:
    """Write the inertials into the source; yields each change, in words. Raises InvalidRepair."""
    _check(source, wanted)
    chosen = _chosen(source, wanted.links)
    found, failed = filled_links(source, list(chosen))
    density = (
        wanted.density if wanted.density is not None else _density(source, wanted.total_mass or 0.0, found, failed)
    )
    for name, link in chosen.items():
        if name in found:
            yield _written(link, found[name], density)
        elif name in failed:
            yield f"{describe(link)}: left as it is, because {failed[name]}"


def _check(source: Source, wanted: InertialsFromMeshes) -> None:
    given = [number for number in (wanted.density, wanted.total_mass) if number is not None]
    if len(given) != 1:
        raise _error(source, "one of density and total_mass is needed", "give InertialsFromMeshes(density=…)")
    try:
        sound = isfinite(given[0]) and given[0] > 0
    except TypeError:
        sound = False
    if not sound:
        raise _error(source, f"{given[0]!r} is no density or mass", "give a positive number, in kg/m³ or kg")


def _chosen(source: Source, links: Literal["missing", "all"] | Collection[str]) -> dict[str, etree._Element]:
    known = {name_of(link): link for link in source.links}
    if links == "all":
        return known
    if links == "missing":
        return {name: link for name, link in known.items() if link.find("inertial") is None}
    if isinstance(links, str):
        raise _error(source, f"links is the string '{links}'", f"give 'missing', 'all' or names: ('{links}',)")
    unknown = [name for name in links if name not in known]
    if unknown:
        raise _error(source, f"there is no link {listed(unknown)}", f"known: {listed(known)}")
    return {name: link for name, link in known.items() if name in links}


def _density(source: Source, total: float, found: dict[str, FilledLink], failed: dict[str, str]) -> float:
    """The density with which the robot has this mass [kg/m³]."""
    if failed:
        link, reason = next(iter(failed.items()))
        raise _error(source, f"the volume of link {listed([link])} is not known: {reason}", "give a density instead")
    if not found:
        raise _error(source, "no link without <inertial> has a shape", "give the links that are to be changed: links=…")
    keep = [link for link in source.links if name_of(link) not in found and link.find("inertial") is not None]
    kept = sum((values(link.find("inertial/mass"), "value", 1) or [0.0])[0] for link in keep)
    volume = sum(link.filled.volume for link in found.values())
    if total <= kept:
        problem = f"total_mass is {total:g} kg, but the links that keep their <inertial> have {kept:g} kg"
        raise _error(
            source,
            problem,
            f"give the mass of the whole robot, or links='all' (--repair inertials-from-meshes={total:g}kg,all)",
        )
    return (total - kept) / volume


def _written(link: etree._Element, shape: FilledLink, density: float) -> str:
    """The change, in words, once it is made."""
    solid = shape.filled
    element = inertial_element(Body(name_of(link), density * solid.volume, solid.center, density * solid.tensor))
    old = link.find("inertial")
    before = "no <inertial>" if old is None else _numbers(old)
    for each in link.findall("inertial"):
        link.remove(each)
    link.append(element)
    what = f"{'the convex hull of ' if solid.hull else ''}its {shape.geometry} {'mesh' if shape.mesh else 'shape'}"
    said = f"{describe(link)}: {before} → {_numbers(element)}, from {what}, {density:.6g} kg/m³"
    return f"{line_said(link)}: {said}" if line_of(link) else said


def _numbers(inertial: etree._Element) -> str:
    """All numbers of an <inertial> under their names, to six digits."""
    elements = [child for tag in ("mass", "origin", "inertia") for child in inertial.findall(tag)]
    said = [
        (tag_of(each) if key == "value" else str(key), str(text)) for each in elements for key, text in each.items()
    ]
    return ", ".join(f"{name} {_rounded(text)}" for name, text in said)


def _rounded(text: str) -> str:
    try:
        return " ".join(f"{float(word):.6g}" for word in text.split())
    except ValueError:
        return text


def _error(source: Source, problem: str, remedy: str) -> InvalidRepair:
    return InvalidRepair(f"inertials-from-meshes: {problem}", remedy, path=source.path)
