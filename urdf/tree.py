"""The tree of links: parents first, depth first, siblings in file order."""

from __future__ import annotations

from lxml import etree

from urdf.errors import NotATree
from urdf.source import Source, name_of


def joints_in_order(source: Source) -> tuple[str, list[str]]:
    """Name of the root link, and the joint names, parents before children.

    Raises NotATree for a joint to a link that does not exist, a link with two parents, several roots, a cycle.
    """
    children = _children(source)
    root = _root(source)
    order, waiting = [], list(reversed(children[root]))
    while waiting:
        joint = waiting.pop()
        order.append(name_of(joint))
        waiting += reversed(children[_end(joint, "child")])
    if len(order) < len(source.joints):
        _refuse_cycle(source, set(order))
    return root, order


def _end(joint: etree._Element, side: str) -> str:
    """Name of the link at the "parent" or "child" side of a joint."""
    end = joint.find(side)
    return "" if end is None else end.get("link", "")


def _children(source: Source) -> dict[str, list[etree._Element]]:
    """Per link: the joints that it is the parent of, in file order."""
    children: dict[str, list[etree._Element]] = {name_of(link): [] for link in source.links}
    for joint in source.joints:
        for side in ("parent", "child"):
            if _end(joint, side) not in children:
                raise source.error(
                    NotATree, joint, f"{side} link '{_end(joint, side)}' does not exist", "correct the name or add it"
                )
        children[_end(joint, "parent")].append(joint)
    return children


def _root(source: Source) -> str:
    """The one link that is no child. A link with two parents is refused on the way."""
    carrier: dict[str, str] = {}
    for joint in source.joints:
        child = _end(joint, "child")
        if child in carrier:
            raise source.error(
                NotATree,
                joint,
                f"link '{child}' is the child of joint '{carrier[child]}' too",
                "a link has one parent; closed loops cannot be represented",
            )
        carrier[child] = name_of(joint)
    roots = [name_of(link) for link in source.links if name_of(link) not in carrier]
    if not roots:
        raise source.error(NotATree, source.robot, "no root: every link is the child of a joint", "remove the cycle")
    if len(roots) > 1:
        names = ", ".join(f"'{name}'" for name in roots)
        raise source.error(NotATree, source.robot, f"several root links: {names}", "connect them with fixed joints")
    return roots[0]


def _refuse_cycle(source: Source, reached: set[str]) -> None:
    cyclic = [joint for joint in source.joints if name_of(joint) not in reached]
    names = ", ".join(f"'{name_of(joint)}'" for joint in cyclic)
    raise source.error(
        NotATree, cyclic[0], f"a cycle that the root does not reach, joints {names}", "connect them to the root"
    )
