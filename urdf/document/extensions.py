"""What a file has beside the tree of rigid bodies: elements that close loops, change dynamics, or are unknown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from urdf.document.connections.loop_elements import read
from urdf.document.connections.loops import Closure, Motor, Unread, place_of
from urdf.document.elements import children, describe, file_of, line_of, name_of, tag_of, written_tag
from urdf.document.vocabulary import (
    ATTRIBUTES,
    CLOSING_CHILDREN,
    FIXED_JOINT_CHILDREN,
    HARMLESS_CHILDREN,
    LOOPS,
    READ_CHILDREN,
    UNREAD_CHANGES,
)
from urdf.errors import shortened


@dataclass(frozen=True)
class Extensions:
    """What a document has beside the tree of rigid bodies."""

    closures: tuple[Closure, ...] = ()
    motors: tuple[Motor, ...] = ()
    unread: tuple[Unread, ...] = ()


def extensions(robot: etree._Element, path: Path) -> Extensions:
    """Extensions of a document that still has all its elements."""
    return Extensions(tuple(_closures(robot, path)), tuple(_motors(robot, path)), tuple(_unread(robot)))


def _closures(robot: etree._Element, path: Path) -> Iterator[Closure]:
    links = frozenset(name_of(link) for link in robot if tag_of(link) == "link")
    for parent in (robot, *robot):
        meanings = CLOSING_CHILDREN.get(tag_of(parent), {})
        for element in parent.iterchildren(etree.Element) if meanings else ():
            meaning = meanings.get(written_tag(element))
            if meaning is not None:
                name = f"'{shortened(name_of(element))}'" if name_of(element) else "it"
                place = place_of(element, path)
                says = read(element, links, place) if parent is robot else None
                yield Closure(place, f"{name} {meaning}", links & _quoted(element), says)


def _motors(robot: etree._Element, path: Path) -> Iterator[Motor]:
    """Motors of <transmission>: the joints that have an <actuator>."""
    for transmission in children(robot, "transmission"):
        if next(children(transmission, "actuator"), None) is not None:
            for joint in children(transmission, "joint"):
                yield Motor(name_of(joint), place_of(transmission, path))


def _quoted(element: etree._Element) -> frozenset[str]:
    """All texts and attributes of an element, without its own name."""
    inside = [text for child in element.iterdescendants(etree.Element) for text in child.attrib.values()]
    texts = [child.text or "" for child in element.iter(etree.Element)]
    own = [text for name, text in element.attrib.items() if name != "name"]
    return frozenset(str(text).strip() for text in (*own, *inside, *texts))


def _unread(robot: etree._Element) -> Iterator[Unread]:
    """One per problem, in the order of the file."""
    first: dict[tuple[str, str], etree._Element] = {}
    places: Counter[tuple[str, str]] = Counter()
    for code, problem, element in _places(robot):
        first.setdefault((code, problem), element)
        places[code, problem] += 1
    for (code, problem), element in first.items():
        yield Unread(problem, describe(element), line_of(element), file_of(element), code, places[code, problem])


_ON_THE_WAY = {
    **READ_CHILDREN,
    "robot": (*READ_CHILDREN["robot"], *LOOPS, "gazebo", "mujoco", "transmission"),
    "transmission": ("actuator",),
}
"""Per element, its children whose children are looked at."""


def _places(parent: etree._Element) -> Iterator[tuple[str, str, etree._Element]]:
    """What is not read in this element and below: code, problem and place."""
    kind = tag_of(parent)
    for name in map(str, parent.attrib if kind in ATTRIBUTES else ()):
        if "}" not in name and name not in ATTRIBUTES[kind]:
            yield "unknown-attribute", f"URDF knows no attribute '{shortened(name)}' of <{kind}>", parent
    fixed = kind == "joint" and parent.get("type") == "fixed"
    for element in parent.iterchildren(etree.Element):
        tag = written_tag(element)
        meaning, applies = UNREAD_CHANGES.get(kind, {}).get(tag, ("", None))
        if applies is not None and applies(element):
            yield "unread-dynamics", f"<{tag}> in <{kind}> {meaning}", element
        elif kind in READ_CHILDREN and not _is_known(kind, tag, element):
            yield "unknown-element", f"URDF knows no <{shortened(tag)}> in <{kind}>", element
        if tag in (FIXED_JOINT_CHILDREN if fixed else _ON_THE_WAY.get(kind, ())):
            yield from _places(element)


def _is_known(kind: str, tag: str, element: etree._Element) -> bool:
    """Elements of xacro have findings of their own."""
    if any(tag in known.get(kind, ()) for known in (READ_CHILDREN, HARMLESS_CHILDREN, CLOSING_CHILDREN)):
        return True
    return (etree.QName(element).namespace or "").rstrip("/").endswith("xacro")
