"""Faults of elements and attributes: each function changes a tree in place, or leaves it where nothing fits."""

from __future__ import annotations

import copy
import random
import re
from collections.abc import Callable

from lxml import etree
from mutants.material import NAMES, NUMBERS, PIECES, TAGS, TYPES

NUMERIC = re.compile(r"^[\s\d.eE+-]+$")


def _elements(tree: etree._Element) -> list[etree._Element]:
    """All elements below the root, those that describe dynamics four times as often."""
    every = list(tree.iterdescendants(etree.Element))
    return every + 3 * [e for e in every if e.tag not in ("visual", "geometry", "mesh", "material", "color")]


def _some(rng: random.Random, tree: etree._Element) -> etree._Element:
    return rng.choice(_elements(tree) or [tree])


def _some_attribute(
    rng: random.Random, tree: etree._Element, wanted: Callable[[str, str], bool] = lambda name, text: True
) -> tuple[etree._Element, str] | None:
    places = [(e, name) for e in [tree, *_elements(tree)] for name, text in e.attrib.items() if wanted(name, text)]
    return rng.choice(places) if places else None


def _numeric(name: str, text: str) -> bool:
    return name not in ("name", "link", "joint") and NUMERIC.match(text) is not None


def _set(element: etree._Element, name: str, text: str) -> None:
    element.set(name, "".join(c for c in text if c.isprintable() or c in "\t\n"))


def delete_element(rng: random.Random, tree: etree._Element) -> None:
    element = _some(rng, tree)
    if element is not tree:
        element.getparent().remove(element)


def duplicate_element(rng: random.Random, tree: etree._Element) -> None:
    element = _some(rng, tree)
    if element is not tree:
        element.addnext(copy.deepcopy(element))


def duplicate_under_new_name(rng: random.Random, tree: etree._Element) -> None:
    element = _some(rng, tree)
    if element is not tree:
        copied = copy.deepcopy(element)
        copied.set("name", "copy")
        element.addnext(copied)


def move_element(rng: random.Random, tree: etree._Element) -> None:
    element, target = _some(rng, tree), _some(rng, tree)
    if element is not tree and element is not target and element not in target.iterancestors():
        target.insert(rng.randint(0, len(target)), element)


def move_to_root(rng: random.Random, tree: etree._Element) -> None:
    element = _some(rng, tree)
    if element is not tree:
        tree.insert(rng.randint(0, len(tree) - 1), element)


def unwrap_element(rng: random.Random, tree: etree._Element) -> None:
    element = _some(rng, tree)
    if element is not tree:
        for child in list(element):
            element.addprevious(child)
        element.getparent().remove(element)


def rename_element(rng: random.Random, tree: etree._Element) -> None:
    _some(rng, tree).tag = rng.choice(TAGS)


def insert_piece(rng: random.Random, tree: etree._Element) -> None:
    target = rng.choice([tree, _some(rng, tree), _some(rng, tree)])
    piece = etree.fromstring(f"<x>{rng.choice(PIECES)}</x>")
    if len(piece):
        target.insert(rng.randint(0, len(target)), piece[0])
    else:
        target.text = (target.text or "") + (piece.text or "")


def delete_attribute(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree):
        del place[0].attrib[place[1]]


def rename_attribute(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree):
        element, name = place
        _set(element, rng.choice([name.upper(), name + "s", "name", "value", "xyz", "type"]), element.attrib.pop(name))


def garble_attribute(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree):
        element, name = place
        text = element.attrib[name]
        k = rng.randint(0, len(text))
        new = rng.choice(["", rng.choice("0123456789.eE+- ,;x/\t\nä"), chr(rng.randint(32, 0x2FFF))])
        _set(element, name, text[:k] + new + text[k + rng.randint(0, 2) :])


def exchange_attributes(rng: random.Random, tree: etree._Element) -> None:
    one, other = _some_attribute(rng, tree), _some_attribute(rng, tree)
    if one and other:
        (a, x), (b, y) = one, other
        a.attrib[x], b.attrib[y] = b.attrib[y], a.attrib[x]


def odd_number(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree, _numeric):
        element, name = place
        words = element.attrib[name].split() or [""]
        words[rng.randrange(len(words))] = rng.choice(NUMBERS)
        _set(element, name, rng.choice([" ", " ", " ", "  ", "\t", "\n", ","]).join(words))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def scaled_number(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree, _numeric):
        element, name = place
        words = element.attrib[name].split() or ["0"]
        k = rng.randrange(len(words))
        if not _is_number(words[k]):  # such as 2e-, where another fault has shortened it
            return
        factor = rng.choice([-1.0, 1e3, 1e-3, 1e6, 1e-6, 1e12, 1e-12, 10 ** rng.uniform(-20, 20), rng.uniform(-2, 2)])
        words[k] = repr(float(words[k]) * factor)
        _set(element, name, " ".join(words))


def shortened_number(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree, _numeric):
        element, name = place
        _set(element, name, " ".join(word[: rng.randint(1, 6)] for word in element.attrib[name].split()))


def lost_or_added_number(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree, _numeric):
        element, name = place
        words = element.attrib[name].split()
        _set(element, name, " ".join(rng.choice([words[1:], words[:-1], [*words, "0"], [*words, "1"]])))


def spaced_number(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree, _numeric):
        element, name = place
        before, between, after = (rng.choice(["", " ", "  ", "\t", "\n"]) for _ in range(3))
        _set(element, name, before + (between or " ").join(element.attrib[name].split()) + after)


def odd_name(rng: random.Random, tree: etree._Element) -> None:
    if place := _some_attribute(rng, tree, lambda name, _: name in ("name", "link", "joint")):
        _set(*place, rng.choice(NAMES))


def odd_name_throughout(rng: random.Random, tree: etree._Element) -> None:
    """A link or a joint has an odd name, and everything refers to it by that name."""
    known = [e.get("name") for e in tree if e.tag in ("link", "joint") and e.get("name")]
    old, new = rng.choice(known or [""]), rng.choice(NAMES)
    for element in tree.iter(etree.Element):
        for name in ("name", "link", "joint"):
            if old and element.get(name) == old:
                _set(element, name, new)


def exchange_names(rng: random.Random, tree: etree._Element) -> None:
    """A reference, or a name, becomes that of something else."""
    known = [e.get("name") for e in tree.iterdescendants(etree.Element) if e.get("name")]
    place = _some_attribute(rng, tree, lambda name, _: name in ("name", "link", "joint"))
    if place and known:
        _set(*place, rng.choice(known))


def change_type(rng: random.Random, tree: etree._Element) -> None:
    joints = [e for e in tree if e.tag == "joint"]
    if joints:
        rng.choice(joints).set("type", rng.choice(TYPES))


def shuffle_elements(rng: random.Random, tree: etree._Element) -> None:
    parent = rng.choice([tree, _some(rng, tree)])
    children = list(parent)
    rng.shuffle(children)
    parent[:] = children


def namespace_of_an_element(rng: random.Random, tree: etree._Element) -> None:
    """xmlns="…" on an element, prefixed or not; the names below may or may not belong to it."""
    element = _some(rng, tree)
    if element is tree or element.tag.startswith("{"):
        return
    uri = rng.choice(["http://www.ros.org", "urn:x", "http://www.ros.org/wiki/xacro"])
    replacement = etree.Element(f"{{{uri}}}{element.tag}", dict(element.attrib), nsmap={rng.choice([None, "n"]): uri})
    below = rng.random() < 0.5
    for child in list(element):
        replacement.append(child)
    if below:
        for child in replacement.iterdescendants(etree.Element):
            if not child.tag.startswith("{"):
                child.tag = f"{{{uri}}}{child.tag}"
    replacement.tail = element.tail
    element.getparent().replace(element, replacement)


ON_TREES = {
    function.__name__.replace("_", " "): function
    for function in (
        delete_element, duplicate_element, duplicate_under_new_name, move_element, move_to_root, unwrap_element,
        rename_element, insert_piece, delete_attribute, rename_attribute, garble_attribute, exchange_attributes,
        odd_number, scaled_number, shortened_number, lost_or_added_number, spaced_number, odd_name,
        odd_name_throughout, exchange_names, change_type, shuffle_elements, namespace_of_an_element,
    )
}  # fmt: skip
