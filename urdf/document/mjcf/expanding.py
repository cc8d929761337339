"""The URDF that an MJCF file says: what MuJoCo compiles, with its frames, as links and joints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from lxml import etree

from graphdyn.layout import Array
from urdf.document.document import BeyondURDF, ExpandedURDF
from urdf.document.mjcf.bodies import Tree
from urdf.document.mjcf.constraints import constraint_elements, held_and_coupled
from urdf.document.mjcf.merging import Place, merged
from urdf.document.mjcf.native import compiled
from urdf.document.mjcf.notes import notes


def is_mjcf(root: etree._Element) -> bool:
    """Whether this is the root element of an MJCF file."""
    return root.tag == "mujoco"


def expand_mjcf(path: Path, content: bytes, root: etree._Element, use_geoms: bool) -> ExpandedURDF:
    """The URDF of an MJCF file; root: its root element, which is modified.

    use_geoms: bodies without <inertial> get that of their geoms

    Raises MujocoNotInstalled; InvalidMJCF, MalformedXML and TooLarge for the file and those that it includes;
    UnsupportedJoint and UnsupportedConstraint for what cannot be represented.
    """
    whole = merged(path, content, root)
    name = root.get("model") or "mujoco"
    native = compiled(whole, use_geoms)
    held, couplings = held_and_coupled(native, whole)
    tree = Tree(native, whole, held, couplings)
    robot = tree.robot(name)
    for element, place in constraint_elements(native, whole, tree):
        tree.add(robot, element, place)
    elements = robot.iter(etree.Element)
    unread = tuple(notes(native, whole, use_geoms))
    return ExpandedURDF(
        etree.tostring(robot, encoding="UTF-8"),
        tuple(_known(tree.places.get(element)) for element in elements),
        tree.gravity,
        BeyondURDF(tree.armature, unread, frozenset(tree.between), native.from_geoms),
    )


@dataclass(frozen=True, eq=False)
class Compiled:
    """What of an MJCF file its URDF does not show.

    body_of: name of the body that a joint moves; anchor: of the joint in that body (3,) [m]; both by joint
    last: joints next to their body, the others of which stand between it and them
    changed_inertials: settings of <compiler> by which inertials are not those of the file
    """

    body_of: Mapping[str, str]
    anchor: Mapping[str, Array]
    last: frozenset[str]
    changed_inertials: tuple[str, ...]


def compiled_mjcf(path: Path, content: bytes, root: etree._Element) -> Compiled:
    """The file as MuJoCo compiles it. Arguments and errors as in expand_mjcf."""
    native = compiled(merged(path, content, root), use_geoms=False)
    model = native.model
    names, bodies = [model.joint(j).name for j in range(model.njnt)], [int(b) for b in model.jnt_bodyid]
    return Compiled(
        {name: model.body(body).name for name, body in zip(names, bodies, strict=True)},
        {name: np.array(model.jnt_pos[j]) for j, name in enumerate(names)},
        frozenset(name for j, name in enumerate(names) if bodies[j + 1 : j + 2] != [bodies[j]]),
        native.changed_inertials,
    )


def _known(place: Place | None) -> tuple[Path, int] | None:
    return None if place is None or place[1] is None else (place[0], place[1])
