"""What joins links besides the tree of a URDF file, read a second time: loops in four dialects, and couplings."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from lxml import etree
from mutants.readings import differs, first
from scipy.spatial.transform import Rotation

import urdf
from graphdyn.layout import Array

DRAKE = "{http://drake.mit.edu}"
KINDS = {
    "revolute": "hinge",
    "continuous": "hinge",
    "prismatic": "slide",
    "spherical": "ball",
    "fixed": "weld",
    "revolute_joint": "hinge",
    "prismatic_joint": "slide",
    "spherical_joint": "ball",
    "link": "weld",
    "distance": "distance",
}


class End(NamedTuple):
    link: str
    translation: Array
    rotation: Array


class Joined(NamedTuple):
    kind: str
    ends: tuple[End, End]
    axis: Array
    length: float | None = None


def named(parent: Any, tag: str) -> list[Any]:
    """Its elements whose tag is written so, without a prefix but that of Drake."""

    def written(e: Any) -> bool:
        return bool(e.tag.startswith(DRAKE) if tag.startswith("drake:") else e.prefix is None)

    local = tag.removeprefix("drake:")
    return [e for e in parent.iterchildren(etree.Element) if written(e) and etree.QName(e).localname == local]


def part(parent: Any, tag: str) -> Any:
    return next(iter(named(parent, tag)), None)


def numbers(element: Any, attribute: str, default: str) -> Array:
    return np.array((default if element is None else element.get(attribute, default)).split(), dtype=float)


def end(link: str, origin: Any, attribute: str = "xyz") -> End:
    turned = Rotation.from_euler("xyz", numbers(origin, "rpy", "0 0 0")).as_matrix()
    return End(link, numbers(origin, attribute, "0 0 0"), turned)


def loop(e: Any) -> Joined:
    one, other = (end(x.get("link"), part(x, "origin")) for x in (part(e, "predecessor"), part(e, "successor")))
    length = float(part(e, "length").get("value")) if e.get("type") == "distance" else None
    return Joined(KINDS[e.get("type")], (one, other), numbers(part(e, "axis"), "xyz", "1 0 0"), length)


def loop_joint(e: Any) -> Joined:
    one, other = (end(x.get("link"), x) for x in (part(e, "link1"), part(e, "link2")))
    return Joined(KINDS[e.get("type")], (one, other), numbers(part(e, "axis"), "xyz", "1 0 0"))


def constraint(e: Any) -> Joined:
    one, other = (end(part(e, x).get("link"), part(e, f"{x}_origin")) for x in ("parent", "child"))
    return Joined(KINDS[e.get("type")], (one, other), numbers(part(e, "parent_axis"), "xyz", "1 0 0"))


def ball(e: Any) -> Joined:
    one, other = (
        end(part(e, f"drake:ball_constraint_body_{x}").get("name"), part(e, f"drake:ball_constraint_p_{p}"), "value")
        for x, p in (("A", "AP"), ("B", "BQ"))
    )
    return Joined("ball", (one, other), np.zeros(3))


DIALECTS: Mapping[str, Callable[[Any], Joined]] = {
    "loop": loop,
    "loop_joint": loop_joint,
    "constraint": constraint,
    "drake:ball_constraint": ball,
}


def joined(path: Path) -> Any:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return urdf.load(path)


def joined_fault(path: Path, found: Any) -> str | None:
    """The chords and couplings are the elements of the file, between the same links at the same places, and so is its
    tree."""
    root = etree.fromstring(path.read_bytes())
    parents = {part(j, "child").get("link"): j for j in named(root, "joint")}
    fused = {link for link, j in parents.items() if j.get("type") == "fixed"}
    (base,) = {e.get("name") for e in named(root, "link")} - set(parents)

    def body_of(link: str) -> str:
        return body_of(part(parents[link], "parent").get("link")) if link in fused else link

    loops = {}
    for tag, read in DIALECTS.items():
        for element in named(root, tag):
            one = read(element)
            if len({body_of(x.link) for x in one.ends}) > 1:  # others hold nothing
                loops[element.get("name") or "-".join(x.link for x in one.ends)] = one

    def chord(one: Any) -> Iterable[str | None]:
        there = loops[one.name]
        yield differs(f"kind of {one.name}", one.kind, there.kind)
        yield differs(f"length of {one.name}", one.length, there.length)
        if there.kind in ("hinge", "slide"):
            yield differs(f"axis of {one.name}", *rounded(one.axis, there.axis / np.linalg.norm(there.axis)))
        bodies = ((one.body_i, one.placement_i), (one.body_j, one.placement_j))
        for (body, placement), at in zip(bodies, there.ends, strict=True):
            yield differs(f"link of {one.name}", found.bodies[body - 1].name if body else base, body_of(at.link))
            if at.link in fused:
                continue
            yield differs(f"place of {one.name}", placement.translation, at.translation)
            yield differs(f"rotation of {one.name}", *rounded(placement.rotation, at.rotation))

    def joint(one: Any) -> Iterable[str | None]:
        element = next(e for e in parents.values() if e.get("name") == one.name)
        axis = numbers(part(element, "axis"), "xyz", "1 0 0")
        yield differs(f"axis of {one.name}", *rounded(one.axis, axis / np.linalg.norm(axis)))

    return (
        differs("names of loops", sorted(c.name for c in found.chords), sorted(map(str, loops)))
        or differs("number of moving links", found.n_bodies, len(parents) - len(fused))
        or first(fault for one in found.chords for fault in chord(one))
        or first(fault for one in found.joints for fault in joint(one))
        or first(coupling_fault(e, found, parents) for e in named(root, "coupling"))
    )


def rounded(*arrays: Array) -> tuple[Array, ...]:
    return tuple(np.round(x, 9) for x in arrays)


def coupling_fault(element: Any, found: Any, parents: Mapping[str, Any]) -> str | None:
    """The positions from the common link to the successor sum up to the ratio times those to the predecessor."""
    q = found.joint_positions(np.linspace(0.3, 1.1, found.nv))
    positions = dict(zip(found.joint_names, q, strict=True))

    def way(link: str) -> list[str]:
        joints = []
        while link in parents:
            joints.append(parents[link].get("name"))
            link = part(parents[link], "parent").get("link")
        return joints

    one, other = (way(part(element, tag).get("link")) for tag in ("predecessor", "successor"))
    sums = [sum(positions.get(name, 0.0) for name in set(x) - set(y)) for x, y in ((one, other), (other, one))]
    ratio = float(part(element, "ratio").get("value"))
    off = abs(sums[1] - ratio * sums[0])
    return None if off <= 1e-9 * (1 + abs(ratio * sums[0])) else f"the coupling {element.get('name')} is off by {off}"
