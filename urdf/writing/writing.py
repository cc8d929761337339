"""A URDF file from the model, written by ourselves: a link per body, a fixed link per frame.

yourdfpy's writer computes roll and yaw separately, from entries of the rotation that vanish at pitch = ±π/2. With the
rounding of one matrix product in the entries, the angles it writes miss the rotation by up to 0.37 within 1e-15 rad of
that pitch, 5e-5 within 1e-8, 1e-8 within 1e-4 (20000 random rotations each); rpy_from_rotation by 8e-16 at most.

Chords are written as <loop>, couplings of several joints as <coupling>: of the forms that are read, URDF+ alone has
both, with a publication and files to go with it. It has no type for a ball and for a distance: these are written as
type "spherical", and "distance" with a <length>. Motors are <transmission> elements, as everywhere in URDF.
"""

from __future__ import annotations

import warnings
from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass
from graphlib import TopologicalSorter
from itertools import chain, count, product
from os import PathLike
from pathlib import Path

import numpy as np
from lxml import etree

from graphdyn import Coupling, Joint, Placement, RobotModel
from graphdyn.model import STANDARD_GRAVITY, check_model
from urdf.document.files import write_whole
from urdf.document.numbers import NO_LIMIT, add_numbers, add_placement, inertial_element, text
from urdf.errors import CannotSave, GravityNotSavedWarning, one_line, shortened

LOOP_TYPES = {"hinge": "revolute", "slide": "prismatic", "weld": "fixed", "ball": "spherical", "distance": "distance"}
"""Loop types by the kind of a chord: the type of <loop>."""


def loop_elements(model: RobotModel) -> Iterator[etree._Element]:
    """One <loop> per chord."""
    links = (model.base_name, *model.body_names)
    for chord in model.chords:
        loop = etree.Element("loop", name=chord.name, type=LOOP_TYPES[chord.kind])
        add_placement(etree.SubElement(loop, "predecessor", link=links[chord.body_i]), chord.placement_i)
        add_placement(etree.SubElement(loop, "successor", link=links[chord.body_j]), chord.placement_j)
        etree.SubElement(loop, "axis", xyz=text(chord.axis))
        if chord.length is not None:
            etree.SubElement(loop, "length", value=repr(chord.length))
        yield loop


def coupling_elements(model: RobotModel) -> Iterator[etree._Element]:
    """One <coupling> per coupling of several joints; those that drive others before these.

    Raises CannotSave for a coupling with an offset, and for one that is not of two sums from a common ancestor.
    """
    driven = {coupling.joint: coupling for coupling in model.couplings}
    order = TopologicalSorter({name: coupling.ratios for name, coupling in driven.items()}).static_order()
    for coupling in (driven[name] for name in order if name in driven):
        if len(coupling.ratios) > 1:
            predecessor, successor, ratio = _sums(model, coupling)
            element = etree.Element("coupling", name=f"{coupling.joint}_coupling")
            etree.SubElement(element, "predecessor", link=predecessor)
            etree.SubElement(element, "successor", link=successor)
            etree.SubElement(element, "ratio", value=repr(ratio))
            yield element


def independent_marks(model: RobotModel) -> dict[str, str]:
    """The attribute independent= of each joint in a coupling of several."""
    driven = {coupling.joint for coupling in model.couplings}
    several = [coupling for coupling in model.couplings if len(coupling.ratios) > 1]
    named = {name for coupling in several for name in (coupling.joint, *coupling.ratios)}
    return {name: "false" if name in driven else "true" for name in named}


def transmission_elements(model: RobotModel) -> Iterator[etree._Element]:
    """One <transmission> per actuated joint."""
    for joint in model.actuated or ():
        transmission = etree.Element("transmission", name=f"{joint}_transmission")
        etree.SubElement(transmission, "type").text = "transmission_interface/SimpleTransmission"
        etree.SubElement(transmission, "joint", name=joint)
        etree.SubElement(transmission, "actuator", name=f"{joint}_motor")
        yield transmission


def _sums(model: RobotModel, coupling: Coupling) -> tuple[str, str, float]:
    """The two links of <coupling>, and the ratio of the sum down to the second to that down to the first."""
    index = {name: k for k, name in enumerate(model.joint_names)}
    wanted = {index[coupling.joint]: 1.0} | {index[name]: -ratio for name, ratio in coupling.ratios.items()}
    ends = {0, *(j + 1 for j in wanted), *(model.joints[j].inside for j in wanted)}
    ways = {body: _way(model, body) for body in ends}
    for predecessor, successor in product(sorted(ends), repeat=2) if coupling.offset == 0 else ():
        up, down = ways[predecessor] - ways[successor], ways[successor] - ways[predecessor]
        if index[coupling.joint] in down and up | down == wanted.keys():
            ratios = {-wanted[j] for j in up} or {1.0}
            if {wanted[j] for j in down} == {1.0} and len(ratios) == 1:
                links = (model.base_name, *model.body_names)
                return links[predecessor], links[successor], ratios.pop()
    raise CannotSave(
        f"joint '{shortened(coupling.joint)}' is driven by {len(coupling.ratios)} joints, and neither <mimic> nor "
        "<coupling> can say how",
        "save model.uncoupled, and state the coupling where the file is loaded",
    )


def _way(model: RobotModel, body: int) -> set[int]:
    """Indices of the joints between the ground and a body."""
    way = set()
    while body:
        way.add(body - 1)
        body = model.joints[body - 1].inside
    return way


@dataclass(frozen=True, eq=False)
class _FixedLink:
    """A link without inertia, and the fixed joint that carries it."""

    name: str
    joint: str
    parent: str
    placement: Placement


def robot_element(model: RobotModel) -> etree._Element:
    """The model as XML. Raises CannotSave for names and couplings that a URDF cannot have."""
    links = (model.base_name, *model.body_names)
    frames = _fixed_links(model, links)
    link_names = [*links, *(frame.name for frame in frames)]
    chord_names = [chord.name for chord in model.chords]
    _check_names([model.name, *link_names, *model.joint_names, *(frame.joint for frame in frames), *chord_names])

    mimics = {coupling.joint: coupling for coupling in model.couplings if len(coupling.ratios) == 1}
    marks = independent_marks(model)
    robot = etree.Element("robot", name=model.name)
    root = model.base_name
    if not _is_identity(model.base):
        root = _free_name("world", link_names)
        etree.SubElement(robot, "link", name=root)
    etree.SubElement(robot, "link", name=model.base_name)
    for body in model.bodies:
        link = etree.SubElement(robot, "link", name=body.name)
        if body.mass != 0 or body.inertia.any():  # without <inertial>, loading warns of the missing mass
            link.append(inertial_element(body))
    for frame in frames:
        etree.SubElement(robot, "link", name=frame.name)

    if root != model.base_name:
        joint_names = [*model.joint_names, *(frame.joint for frame in frames)]
        _add_joint(robot, _free_name(model.base_name, joint_names), "fixed", root, model.base_name, model.base)
    for joint, body in zip(model.joints, model.bodies, strict=True):
        element = _add_joint(robot, joint.name, joint.kind, links[joint.inside], body.name, joint.placement)
        _add_motion(element, joint)
        if joint.name in mimics:
            element.append(_mimic(mimics[joint.name]))
        if joint.name in marks:
            element.set("independent", marks[joint.name])
    for frame in frames:
        _add_joint(robot, frame.joint, "fixed", frame.parent, frame.name, frame.placement)
    robot.extend([*coupling_elements(model), *loop_elements(model), *transmission_elements(model)])
    return robot


def _fixed_links(model: RobotModel, links: tuple[str, ...]) -> list[_FixedLink]:
    """The frames as links.

    The fixed joint has the name of the frame's first alias. Without an alias it has the frame's own name: a joint
    named like a link gives the reloaded frame no alias. Further aliases become links of their own at the same place.
    """
    joints = set(model.joint_names)
    fixed = []
    for frame in model.frames:
        first = next((alias for alias in frame.aliases if alias not in joints), frame.name)
        for name in (frame.name, *(alias for alias in frame.aliases if alias != first)):
            joint = _free_name(first if name == frame.name else name, joints)
            joints.add(joint)
            fixed.append(_FixedLink(name, joint, links[frame.body], frame.placement))
    return fixed


def _free_name(wish: str, taken: Container[str]) -> str:
    """The wanted name, or the first of wish_1, wish_2, … that is not taken."""
    candidates = chain([wish], (f"{wish}_{k}" for k in count(1)))
    return next(name for name in candidates if name not in taken)


def _check_names(names: Iterable[str]) -> None:
    for name in names:
        if not name:
            raise CannotSave("the robot, a link, a joint or a chord has an empty name", "give it a name")
        try:
            etree.Element("link", name=name)
        except ValueError as error:
            raise CannotSave(f"the name {name!r} cannot stand in XML", "rename it") from error


def _is_identity(placement: Placement) -> bool:
    return np.array_equal(placement.rotation, np.eye(3)) and not placement.translation.any()


def _add_joint(
    robot: etree._Element, name: str, kind: str, parent: str, child: str, placement: Placement
) -> etree._Element:
    joint = etree.SubElement(robot, "joint", name=name, type=kind)
    add_placement(joint, placement)
    etree.SubElement(joint, "parent", link=parent)
    etree.SubElement(joint, "child", link=child)
    return joint


def _add_motion(element: etree._Element, joint: Joint) -> None:
    """Axis, limits, damping and friction of a movable joint."""
    etree.SubElement(element, "axis", xyz=text(joint.axis))
    bounds = _limits(joint)
    if bounds:
        add_numbers(element, "limit", bounds)
    if joint.damping or joint.friction:
        add_numbers(element, "dynamics", {"damping": joint.damping, "friction": joint.friction})


def _limits(joint: Joint) -> dict[str, float]:
    """The attributes of <limit>; empty where the joint needs none."""
    unlimited = {"lower": -NO_LIMIT, "upper": NO_LIMIT, "effort": NO_LIMIT, "velocity": NO_LIMIT}
    position = {"lower", "upper"} if joint.kind != "continuous" else set()
    stated = {name: getattr(joint.limits, name) for name in unlimited if name in position | {"effort", "velocity"}}
    stated = {name: limit for name, limit in stated.items() if limit is not None}
    if joint.kind == "continuous" and not stated:
        return {}
    written = {"effort", "velocity"} | (position if position & stated.keys() else set())  # a single bound is not enough
    return {name: stated.get(name, limit) for name, limit in unlimited.items() if name in written}


def _mimic(coupling: Coupling) -> etree._Element:
    ((driver, ratio),) = coupling.ratios.items()
    return etree.Element("mimic", joint=driver, multiplier=repr(ratio), offset=repr(float(coupling.offset)))


def save(model: RobotModel, path: str | PathLike[str]) -> None:
    """Write the model as URDF; urdf.load gives it back, to rounding.

    The order of bodies comes back if they are numbered depth first, as load does. A frame becomes a link on a fixed
    joint that is named after its first alias. A base placement becomes a root link "world" with a fixed joint. A
    missing effort or velocity limit is written as the largest double (NO_LIMIT); a continuous joint has no position
    limits. A body without mass and inertia gets no <inertial>. Chords become <loop> elements of URDF+, joints
    that several others drive its <coupling>, and actuated joints <transmission> elements.

    The file appears complete or not at all. Raises CannotSave for a name that is empty or cannot stand in XML, and for
    a joint that several others drive otherwise than <coupling> can say: two sums from a common ancestor, no offset.
    Warns GravityNotSavedWarning where gravity is not (0, 0, -9.81): URDF has no place for it.
    """
    check_model(model)
    path = Path(path)
    write_whole(path, urdf_document(model))
    if not np.array_equal(model.gravity, STANDARD_GRAVITY):
        reload = f"reload with urdf.load(..., gravity={model.gravity.tolist()})"
        message = f"{one_line(str(path))}: a URDF file cannot state gravity; {reload}"
        warnings.warn(message, GravityNotSavedWarning, stacklevel=2)


def urdf_document(model: RobotModel) -> bytes:
    """What save writes. Raises CannotSave."""
    document: bytes = etree.tostring(robot_element(model), xml_declaration=True, encoding="UTF-8", pretty_print=True)
    return document
