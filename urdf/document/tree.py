"""The tree of links: parents first, depth first, siblings in file order."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence

from lxml import etree

from urdf.document.elements import name_of
from urdf.document.source import Source
from urdf.errors import NotATree, URDFError, listed, shortened

Joints = Mapping[str, Sequence[etree._Element]]
"""Per link, by name: joints."""


def joints_in_order(source: Source) -> tuple[str, list[str]]:
    """Name of the root link, and the joint names, parents before children, of a valid tree."""
    (root,) = root_links(source)
    return root, [name_of(joint) for joint in walk(joints_by(source, "parent"), [root])]


def tree_faults(source: Source) -> Iterator[URDFError]:
    """A NotATree for each joint to a link that does not exist, link with two parents, several roots, cycle."""
    links = {name_of(link) for link in source.links}
    for joint in source.joints:
        for side in ("parent", "child"):
            name = end(joint, side)
            if name is not None and name not in links:
                problem = f"{side} link '{shortened(name)}' does not exist"
                yield source.error(NotATree, "missing-link", _side(joint, side), problem, "correct the name or add it")
    carried = joints_by(source, "child")
    for child, joints in carried.items():
        for joint in joints[1:]:
            problem = f"link '{shortened(child)}' is the child of joint '{shortened(name_of(joints[0]))}' too"
            remedy = "a link has one parent; close the loop by <loop> instead of a second <joint>"
            yield source.error(NotATree, "two-parents", _side(joint, "child"), problem, remedy)
    roots = root_links(source)
    if not roots and links:
        problem = "no root: every link is the child of a joint"
        yield source.error(NotATree, "no-root", source.robot, problem, "remove the cycle")
        return
    if len(roots) > 1:
        problem = f"several root links: {listed(roots)}"
        yield source.error(NotATree, "several-roots", source.robot, problem, "connect them with fixed joints")
    carriers = joints_by(source, "parent")
    held = {end(joint, "child") for joint in source.joints if end(joint, "parent") is not None}
    reached = set(walk(carriers, [name for name in {**dict.fromkeys(links), **carriers} if name not in held]))
    cyclic = [joint for joint in source.joints if joint not in reached and end(joint, "parent") is not None]
    if cyclic:
        problem = f"a cycle that the root does not reach, joints {listed(map(name_of, cyclic))}"
        yield source.error(NotATree, "cycle", cyclic[0], problem, "connect them to the root")


def root_links(source: Source) -> list[str]:
    """Names of the links that are not the child of a joint, in file order."""
    carried = joints_by(source, "child")
    return [name for name in dict.fromkeys(map(name_of, source.links)) if name not in carried]


def joints_by(source: Source, side: str) -> dict[str, list[etree._Element]]:
    """Per link: the joints with this link at their "parent" or "child" side, in file order."""
    found: dict[str, list[etree._Element]] = {}
    for joint in source.joints:
        name = end(joint, side)
        if name is not None:
            found.setdefault(name, []).append(joint)
    return found


def joint_into(source: Source) -> dict[str, etree._Element]:
    """Per link: the first joint that it is the child of."""
    return {child: joints[0] for child, joints in joints_by(source, "child").items()}


def path_up(into: Mapping[str, etree._Element], link: str) -> list[etree._Element]:
    """The joints from this link up to the root, of a valid tree."""
    joints = []
    while link in into:
        joints.append(into[link])
        link = end(into[link], "parent") or ""
    return joints


def carriers(source: Source, locked: Container[str] = ()) -> dict[str, str | None]:
    """Per link that a root reaches: the first link of the body that carries it, None where it never moves.

    locked: names of joints that are held still
    """
    roots = root_links(source)
    found: dict[str, str | None] = dict.fromkeys(roots)
    for joint in walk(joints_by(source, "parent"), roots):
        parent, child = end(joint, "parent"), end(joint, "child")
        if parent is not None and child is not None:
            still = joint.get("type") == "fixed" or name_of(joint) in locked
            found.setdefault(child, found.get(parent) if still else child)
    return found


def walk(carriers: Joints, roots: Sequence[str]) -> Iterator[etree._Element]:
    """The joints reached from these links, parents first, depth first; each once, even where they are not a tree.

    carriers: per link, the joints that it is the parent of
    """
    seen: set[etree._Element] = set()
    waiting = [joint for root in reversed(roots) for joint in reversed(carriers.get(root, ()))]
    while waiting:
        joint = waiting.pop()
        if joint in seen:
            continue
        seen.add(joint)
        yield joint
        waiting += reversed(carriers.get(end(joint, "child") or "", ()))


def end(joint: etree._Element, side: str) -> str | None:
    """Name of the link at the "parent" or "child" side of a joint; None where the file has none."""
    found = next(joint.iterchildren(side), None)
    return None if found is None else found.get("link")


def _side(joint: etree._Element, side: str) -> etree._Element:
    """The element that names a link, in a joint that has it."""
    return next(joint.iterchildren(side))
