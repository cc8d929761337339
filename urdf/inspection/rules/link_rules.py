"""Findings about the links: inertials that are missing, dropped, guessed or impossible."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from lxml import etree

from graphdyn.model import TRIANGLE_TOLERANCE_SHARE
from urdf.document.elements import name_of
from urdf.document.numbers import values
from urdf.errors import shortened
from urdf.inspection.findings import Finding, about, of_file
from urdf.inspection.structure import LinkInertial, Structure
from urdf.reading.corrections import only_change

TRIANGLE_TOLERANCE = 0.02
"""Violation of a triangle inequality, as a part of the largest moment, below which it comes from few digits."""

MIN_PLAUSIBLE_MASS = 1e-4
"""Mass below which it is probably a placeholder [kg]."""

MAX_GYRATION_RADIUS = 2.0
"""Radius of gyration beyond which lengths are probably in other units [m]."""

MAX_CENTER_DISTANCE = 50.0
"""Distance of a center of mass from its link origin beyond which it is probably in other units [m]."""

MAX_GYRATION_RATIO, MIN_LINK_SIZE = 5.0, 0.1
"""A radius of gyration beyond MAX_GYRATION_RATIO times the link's size is implausible; no link counts as smaller
than MIN_LINK_SIZE [m]."""

MIN_EQUAL_LINKS = 3
"""Number of links from which equal inertials are not a coincidence."""


def link_findings(structure: Structure) -> Iterator[Finding]:
    """Findings about the links in the order of the file."""
    yield from _ground(structure)
    yield from _missing(structure)
    moving = [inertial for inertial in structure.inertials if structure.moving(inertial.link)]
    for inertial in moving:
        yield from _form(structure, inertial)
        yield from _mass(structure, inertial)
        if inertial.size > 0:
            yield from _tensor(inertial)
            yield from _radius(structure, inertial)
    yield from _placeholders(moving)


def _ground(structure: Structure) -> Iterator[Finding]:
    for inertial in structure.inertials:
        if structure.still(inertial.link) and (inertial.mass > 0 or inertial.size > 0):
            yield about(
                "root-inertia",
                inertial.element,
                f"a mass of {inertial.mass:g} kg that never moves: load drops it, and no torque regressor contains it",
            )


def _missing(structure: Structure) -> Iterator[Finding]:
    links = {name_of(link): link for link in structure.source.links}
    for carrier, members in structure.members.items():
        if carrier in links and all(name in links and links[name].find("inertial") is None for name in members):
            fixed = " (nor has any link fixed to it)" if len(members) > 1 else ""
            problem = f"the link moves and has no <inertial>{fixed}: its mass is zero"
            yield about("missing-inertial", links[carrier], problem)


def _form(structure: Structure, inertial: LinkInertial) -> Iterator[Finding]:
    """How the <inertial> is written."""
    element, carrier = inertial.element, structure.carrier[inertial.link]
    if carrier != inertial.link and inertial.mass > 0:
        yield about(
            "fused-mass",
            element,
            f"the link is fixed: its {inertial.mass:g} kg are added to the body of link '{shortened(str(carrier))}'",
        )
    origin = element.find("origin")
    if origin is None:
        yield about("inertial-origin-missing", element, "without <origin>: the center of mass is the link origin")
    if any(values(origin, "rpy", 3) or ()):
        yield about(
            "inertial-rotated",
            _part(element, "origin"),
            "the inertial frame is rotated: the tensor is turned into link axes",
        )
    if np.abs(np.triu(inertial.tensor, 1)).any():
        yield about("off-diagonal-inertia", _part(element, "inertia"), "the tensor has off-diagonal entries")


def _mass(structure: Structure, inertial: LinkInertial) -> Iterator[Finding]:
    element, mass = inertial.element, inertial.mass
    if mass == 0:
        members = structure.members[str(structure.carrier[inertial.link])]
        alone = not any(other.mass > 0 and other.link in members for other in structure.inertials)
        problem = "the mass is zero" if inertial.size == 0 else "the mass is zero but the inertia tensor is not"
        yield about("zero-mass", _part(element, "mass"), problem, severity="warning" if alone else "note")
    elif inertial.size == 0:
        yield about(
            "zero-inertia", _part(element, "inertia"), f"{mass:g} kg with an inertia tensor of zero: a point mass"
        )
    distance = float(np.linalg.norm(inertial.center))
    if distance > MAX_CENTER_DISTANCE:
        problem = f"the center of mass is {distance:.3g} m from the origin of the link"
        yield about("far-center-of-mass", _part(element, "origin"), problem)
    if 0 < mass < MIN_PLAUSIBLE_MASS:
        yield about("tiny-mass", _part(element, "mass"), f"the mass is {mass:g} kg")


def _tensor(inertial: LinkInertial) -> Iterator[Finding]:
    element, (low, middle, high), size = inertial.element, inertial.moments, inertial.size
    if low < -TRIANGLE_TOLERANCE_SHARE * size:
        problem = f"the tensor has a negative principal moment, {low:.3g} kg m²: no real body has one{_meant(element)}"
        yield about("indefinite-inertia", _part(element, "inertia"), problem)
    elif low <= TRIANGLE_TOLERANCE_SHARE * size:
        yield about(
            "singular-inertia",
            _part(element, "inertia"),
            f"the tensor is singular: smallest principal moment {low:.3g} kg m²",
        )
    excess = high - low - middle
    if excess > TRIANGLE_TOLERANCE_SHARE * size:
        rounded = excess < TRIANGLE_TOLERANCE * high
        problem = f"principal moment {high:.3g} exceeds the sum {low + middle:.3g} kg m² of the others{_meant(element)}"
        yield about(
            "triangle-inequality", _part(element, "inertia"), problem, severity="note" if rounded else "warning"
        )
    if low > 0 and np.array_equal(inertial.tensor, inertial.tensor[0, 0] * np.eye(3)):
        yield about(
            "isotropic-inertia",
            _part(element, "inertia"),
            "the same moment about every axis, as of a sphere: probably a guess",
        )


def _part(inertial: etree._Element, tag: str) -> etree._Element:
    """The child that states what a finding is about, where it is written."""
    part = inertial.find(tag)
    return inertial if part is None else part


def _meant(inertial: etree._Element) -> str:
    """The tensor that is probably meant."""
    found = only_change(inertial)
    return "" if found is None else f"; with {found.what} it is possible"


def _radius(structure: Structure, inertial: LinkInertial) -> Iterator[Finding]:
    if inertial.mass == 0:
        return
    radius = float(np.sqrt(max(inertial.moments[2], 0.0) / inertial.mass))
    places = (values(joint.find("origin"), "xyz", 3) for joint in structure.joints_from.get(inertial.link, ()))
    ends = [inertial.center, *(np.array(place) for place in places if place is not None)]
    size = max(MIN_LINK_SIZE, *(float(np.linalg.norm(end)) for end in ends))
    if radius > MAX_GYRATION_RADIUS or radius > MAX_GYRATION_RATIO * size:
        problem = f"the radius of gyration is {radius:.3g} m, the link reaches {size:.3g} m: tensor and mass do not fit"
        yield about("gyration-radius", inertial.element, problem)


def _placeholders(moving: list[LinkInertial]) -> Iterator[Finding]:
    same = {(inertial.mass, inertial.tensor.tobytes()) for inertial in moving}
    if len(moving) >= MIN_EQUAL_LINKS and len(same) == 1:
        yield of_file(
            "placeholder-inertials",
            f"all {len(moving)} moving links with <inertial> have the same mass, {moving[0].mass:g} kg, and tensor: "
            "placeholders",
        )
