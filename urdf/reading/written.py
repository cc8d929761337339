"""The numbers of a URDF file as it writes them: decimals as fractions, before anything is rounded, turned or added."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Unpack

from lxml import etree

from graphdyn.display import short_repr
from urdf.document.opening import Given
from urdf.document.tree import joints_in_order
from urdf.reading.parsing import Parsed, parsed_source
from urdf.reading.reading import Reading, ReadingKeywords

Fractions = tuple[Fraction, ...]


@dataclass(frozen=True)
class WrittenOrigin:
    """An <origin>, zeros without one: xyz [m], rpy [rad]."""

    xyz: Fractions
    rpy: Fractions


@dataclass(frozen=True)
@short_repr
class WrittenInertial:
    """An <inertial>: mass [kg]; tensor (3, 3) [kg m²] about the center of mass, in the axes of the origin."""

    origin: WrittenOrigin
    mass: Fraction
    tensor: tuple[Fractions, ...]


@dataclass(frozen=True)
class WrittenJoint:
    """A <joint> of the file.

    axis: as written, of any length
    held: where a joint stands that does not move, fixed ones at 0; None for one that moves [rad or m]
    """

    name: str
    prismatic: bool
    parent: str
    child: str
    origin: WrittenOrigin
    axis: Fractions
    held: Fraction | None


@dataclass(frozen=True)
class WrittenMimic:
    """A <mimic>: the position of the joint is ratio times that of the driver, plus the offset."""

    joint: str
    driver: str
    ratio: Fraction
    offset: Fraction


@dataclass(frozen=True)
@short_repr
class WrittenRobot:
    """The numbers of a file.

    root: name of the ground link; joints: parents first, those that move in the order of the model
    inertials: by the name of the link; mimics: by the name of the joint, those that are followed
    """

    root: str
    joints: tuple[WrittenJoint, ...]
    inertials: Mapping[str, WrittenInertial]
    mimics: Mapping[str, WrittenMimic]


def written(source: Given, **reading: Unpack[ReadingKeywords]) -> WrittenRobot:
    """What urdf.load reads, after cuts and repairs, as exact numbers. Arguments and errors as there; no warnings.

    Values of locked joints are the doubles that they are. A joint that mimics one that is held stands where the
    decimals of its <mimic> say.
    """
    how = Reading.of(written, reading)
    _, reduced, parsed = parsed_source(source, how)
    elements = {_text(joint, "name"): joint for joint in reduced.joints}
    root, order = joints_in_order(reduced)
    mimics = _mimics(elements) if how.mimic == "coupled" else {}
    held = _held(elements, parsed, mimics)
    links = {_text(link, "name"): link.find("inertial") for link in reduced.links}
    return WrittenRobot(
        root=root,
        joints=tuple(_joint(elements[name], held) for name in order),
        inertials={name: _inertial(inertial) for name, inertial in links.items() if inertial is not None},
        mimics={name: mimic for name, mimic in mimics.items() if name not in held},
    )


def _mimics(elements: Mapping[str, etree._Element]) -> dict[str, WrittenMimic]:
    found = {}
    for name, joint in elements.items():
        mimic = joint.find("mimic")
        if mimic is not None and joint.get("type") != "fixed":
            ratio, offset = (Fraction(mimic.get(key, default).strip()) for key, default in _MIMIC_NUMBERS)
            found[name] = WrittenMimic(name, mimic.get("joint", ""), ratio, offset)
    return found


_MIMIC_NUMBERS = (("multiplier", "1"), ("offset", "0"))
"""Attributes of a <mimic>, and what holds without them."""


def _held(
    elements: Mapping[str, etree._Element], parsed: Parsed, mimics: Mapping[str, WrittenMimic]
) -> dict[str, Fraction]:
    """Positions of the joints that do not move."""

    def position(name: str) -> Fraction:
        if name not in parsed.locked:
            return Fraction(0)
        if name in parsed.stated or name not in mimics:
            return Fraction(parsed.locked[name])
        mimic = mimics[name]
        return mimic.offset + (mimic.ratio * position(mimic.driver) if mimic.ratio else 0)

    fixed = {name for name, joint in elements.items() if joint.get("type") == "fixed"}
    return {name: position(name) for name in {*parsed.locked, *fixed}}


def _joint(joint: etree._Element, held: Mapping[str, Fraction]) -> WrittenJoint:
    name, axis = _text(joint, "name"), joint.find("axis")
    return WrittenJoint(
        name=name,
        prismatic=joint.get("type") == "prismatic",
        parent=_text(_child(joint, "parent"), "link"),
        child=_text(_child(joint, "child"), "link"),
        origin=_origin(joint),
        axis=_fractions("1 0 0" if axis is None else _text(axis, "xyz")),
        held=held.get(name),
    )


def _inertial(inertial: etree._Element) -> WrittenInertial:
    tensor = _child(inertial, "inertia")

    def entry(row: int, column: int) -> Fraction:
        return Fraction(_text(tensor, f"i{'xyz'[min(row, column)]}{'xyz'[max(row, column)]}").strip())

    rows = tuple(tuple(entry(row, column) for column in range(3)) for row in range(3))
    mass = Fraction(_text(_child(inertial, "mass"), "value").strip())
    return WrittenInertial(_origin(inertial), mass, rows)


def _origin(element: etree._Element) -> WrittenOrigin:
    origin = element.find("origin")
    if origin is None:
        return WrittenOrigin(*((Fraction(0),) * 3,) * 2)
    return WrittenOrigin(_fractions(origin.get("xyz", "0 0 0")), _fractions(origin.get("rpy", "0 0 0")))


def _child(element: etree._Element, tag: str) -> etree._Element:
    """A child that the checks of urdf.load have found."""
    found = element.find(tag)
    assert found is not None
    return found


def _text(element: etree._Element, attribute: str) -> str:
    """An attribute that the checks of urdf.load have found."""
    found = element.get(attribute)
    assert found is not None
    return found


def _fractions(text: str) -> Fractions:
    return tuple(Fraction(word) for word in text.split())
