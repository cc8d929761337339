"""Elements of an XML document: their tag, name and line, and how messages call them."""

from __future__ import annotations

from typing import cast

from lxml import etree

from urdf._wording import shortened


def name_of(element: etree._Element) -> str:
    """Its attribute "name", empty where it has none."""
    return element.get("name", "")


def tag_of(element: etree._Element) -> str:
    """Its tag as written, whatever namespace xmlns="…" puts it into; empty for comments and for tags with a prefix.

    Pinocchio too compares tags as written, and URDF has no tags with a prefix.
    """
    tag = element.tag
    return tag.rpartition("}")[2] if isinstance(tag, str) and element.prefix is None else ""


def written_tag(element: etree._Element) -> str:
    """Its tag as written, with its prefix; empty for comments."""
    tag = element.tag
    local = tag.rpartition("}")[2] if isinstance(tag, str) else ""
    return local if element.prefix is None else f"{element.prefix}:{local}"


def line_of(element: etree._Element) -> int | None:
    return cast("int | None", element.sourceline)


def describe(element: etree._Element) -> str:
    """The element by name: "link 'wrist'", "<mass> of link 'wrist'"."""
    above = (element, *element.iterancestors())
    owner = next((e for e in above if tag_of(e) in ("robot", "link", "joint")), element)
    tag = tag_of(owner)
    named = f"{tag} '{shortened(name_of(owner))}'" if name_of(owner) else f"<{tag}>"
    return named if owner is element else f"<{shortened(written_tag(element))}> of {named}"
