"""What a file has beside the tree of rigid bodies: elements that close loops, change dynamics, or are unknown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from lxml import etree

from urdf._elements import describe, line_of, name_of, tag_of, written_tag
from urdf._errors import UnsupportedConstraint
from urdf._vocabulary import ATTRIBUTES, CHANGES, CLOSES, HARMLESS, READ, RIGID
from urdf._wording import shortened


@dataclass(frozen=True)
class Closure:
    """An element that closes a loop, couples joints or joins links; links: those that it names."""

    element: str
    line: int | None
    problem: str
    links: frozenset[str]


@dataclass(frozen=True)
class Unread:
    """Something that is not read, at one or more places; element, line: the first."""

    code: str
    element: str
    line: int | None
    problem: str
    places: int


@dataclass(frozen=True)
class Extensions:
    """What a document has beside the tree of rigid bodies."""

    closures: tuple[Closure, ...] = ()
    unread: tuple[Unread, ...] = ()


def extensions(robot: etree._Element) -> Extensions:
    """Of a document that still has all its elements."""
    return Extensions(tuple(_closures(robot)), tuple(_unread(robot)))


def closure_faults(
    closures: tuple[Closure, ...], carriers: Mapping[str, str | None], path: Path
) -> Iterator[UnsupportedConstraint]:
    """An error for each element that constrains the model.

    carriers: per link of the model, the body that carries it. An element between links of one body constrains
    nothing, nor does one between links that are not in the model.
    """
    for closure in closures:
        ends = {carriers.get(link, "") for link in closure.links}
        if len(closure.links) < 2 or len(ends) > 1:
            yield UnsupportedConstraint(
                closure.problem,
                "remove it to load the tree without it, or let one body carry the links that it joins (chain=, lock=)",
                path=path,
                line=closure.line,
                element=closure.element,
            )


def _closures(robot: etree._Element) -> Iterator[Closure]:
    links = frozenset(name_of(link) for link in robot if tag_of(link) == "link")
    for parent in (robot, *robot):
        meanings = CLOSES.get(tag_of(parent), {})
        for element in parent.iterchildren(etree.Element):
            meaning = meanings.get(written_tag(element))
            if meaning is not None:
                name = f"'{shortened(name_of(element))}'" if name_of(element) else "it"
                problem = f"{name} {meaning}, and only trees of links are modelled"
                yield Closure(describe(element), line_of(element), problem, links & _quoted(element))


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
        yield Unread(code, describe(element), line_of(element), problem, places[code, problem])


_ON_THE_WAY = {**READ, "robot": (*READ["robot"], "gazebo", "mujoco", "transmission"), "transmission": ("actuator",)}
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
        meaning, applies = CHANGES.get(kind, {}).get(tag, ("", None))
        if applies is not None and applies(element):
            yield "unread-dynamics", f"<{tag}> in <{kind}> {meaning}", element
        elif kind in READ and not _is_known(kind, tag, element):
            yield "unknown-element", f"URDF knows no <{shortened(tag)}> in <{kind}>", element
        if tag in (RIGID if fixed else _ON_THE_WAY.get(kind, ())):
            yield from _places(element)


def _is_known(kind: str, tag: str, element: etree._Element) -> bool:
    """Elements of xacro have findings of their own."""
    namespace = etree.QName(element).namespace or ""
    known = (*READ[kind], *HARMLESS.get(kind, ()), *CLOSES.get(kind, ()))
    return tag in known or namespace.rstrip("/").endswith("xacro")
