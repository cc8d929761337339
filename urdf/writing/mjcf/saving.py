"""An MJCF file from the model, written by ourselves: MuJoCo's own writer has six digits."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain, count
from os import PathLike
from pathlib import Path

import numpy as np
from lxml import etree

from graphdyn import Body, Chord, JointLimits, Placement, RobotModel
from graphdyn.layout import Array
from graphdyn.model import check_model
from urdf.document.files import write_whole
from urdf.document.numbers import text
from urdf.errors import CannotSave, shortened
from urdf.writing.mjcf.grouping import Axis, MovedBody, groups

WORLD = "world"


def save_mjcf(model: RobotModel, path: str | PathLike[str]) -> None:
    """Write the model as MJCF; MuJoCo and urdf.load read the same numbers, to rounding.

    Every number has all its digits. Joints have their limits, damping, friction (frictionloss), armature, and a motor
    each, whose limits are those of the effort; velocity limits have no place there. Frames are sites. A body without
    mass on which one further joint stands becomes a further joint of the next body. Couplings are equalities of
    joints; balls are <connect>, welds <weld>, hinges two <connect>.

    The file appears complete or not at all. Raises CannotSave for inertials that MuJoCo refuses, all of them by name;
    joints that several others drive; chords that slide or keep a distance; names that XML cannot hold.
    """
    check_model(model)
    write_whole(Path(path), mjcf_document(model))


def mjcf_document(model: RobotModel) -> bytes:
    """What save_mjcf writes. Raises CannotSave."""
    try:
        root = _root(model)
    except ValueError as error:
        if isinstance(error, CannotSave):
            raise
        raise CannotSave(f"a name cannot stand in XML: {error}", "rename it") from error
    etree.indent(root)
    document: bytes = etree.tostring(root, encoding="UTF-8", pretty_print=True)
    return document


def _root(model: RobotModel) -> etree._Element:
    bodies = groups(model)
    root = etree.Element("mujoco", model=model.name)
    etree.SubElement(root, "compiler", angle="radian", autolimits="true", inertiafromgeom="false")
    etree.SubElement(root, "option", gravity=text(model.gravity))
    ground = etree.SubElement(root, "worldbody")
    base = model.base
    if model.base_name != WORLD or not _is_identity(base):
        name = model.base_name if model.base_name != WORLD else _free("base", set(model.body_names))
        ground = etree.SubElement(ground, "body", name=name)
        _place(ground, base)
    elements = {0: ground}
    for group in bodies:
        elements[group.number] = _body(elements[group.inside], model, group)
    sites = {frame.name for frame in model.frames}
    for frame in model.frames:
        _site(elements[frame.body], frame.name, frame.placement)
    equality = etree.Element("equality")
    for coupling in model.couplings:
        _couple(equality, coupling.joint, coupling.ratios, coupling.offset)
    for chord in model.chords:
        _close(equality, elements, chord, sites)
    actuator = etree.Element("actuator")
    _add_motors(actuator, model)
    root.extend([part for part in (equality, actuator) if len(part)])
    return root


def _body(parent: etree._Element, model: RobotModel, group: MovedBody) -> etree._Element:
    body = model.bodies[group.number - 1]
    element = etree.SubElement(parent, "body", name=body.name)
    _place(element, group.placement)
    element.append(mjcf_inertial(body))
    for axis in group.axes:
        _add_joint(element, axis)
    return element


def mjcf_inertial(body: Body, center: Array | None = None) -> etree._Element:
    """<inertial> of a body. center: of mass, if the body's frame has another origin than the link (3,) [m]"""
    where = body.center_of_mass if center is None else center
    element = etree.Element("inertial", pos=text(where), mass=repr(body.mass))
    tensor = body.inertia
    if np.array_equal(tensor, np.diag(np.diag(tensor))):
        element.set("diaginertia", text(np.diag(tensor)))
    else:
        element.set("fullinertia", text(np.array([*np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2]])))
    return element


def _add_joint(element: etree._Element, axis: Axis) -> None:
    joint = axis.joint
    written = etree.SubElement(element, "joint", name=joint.name, type="slide" if joint.is_prismatic else "hinge")
    if axis.anchor.any():
        written.set("pos", text(axis.anchor))
    written.set("axis", text(axis.direction))
    limits = joint.limits
    if joint.kind != "continuous" and _is_limited(limits):
        lower, upper = limits.lower, limits.upper
        written.set("range", f"{-UNLIMITED if lower is None else lower!r} {UNLIMITED if upper is None else upper!r}")
    for name, value in (("damping", joint.damping), ("frictionloss", joint.friction), ("armature", joint.armature)):
        if value:
            written.set(name, repr(float(value)))
    if limits.effort:
        written.set("actuatorfrcrange", f"{-limits.effort!r} {limits.effort!r}")


UNLIMITED = 1e10
"""Position limit that MuJoCo takes for none, where a joint has one on the other side only."""


def _is_limited(limits: JointLimits) -> bool:
    lower, upper = limits.lower, limits.upper
    return (lower is not None or upper is not None) and lower != upper


def _couple(equality: etree._Element, joint: str, ratios: object, offset: float) -> None:
    drivers = dict(ratios)  # type: ignore[call-overload]
    if len(drivers) > 1:
        problem = f"joint '{shortened(joint)}' is driven by {len(drivers)} joints, and MuJoCo couples two"
        raise CannotSave(problem, "save model.uncoupled, and state the coupling where the file is used")
    ((driver, ratio),) = drivers.items()
    polynomial = text(np.array([offset, ratio, 0.0, 0.0, 0.0]))
    etree.SubElement(equality, "joint", joint1=joint, joint2=driver, polycoef=polynomial)


def _close(equality: etree._Element, elements: dict[int, etree._Element], chord: Chord, sites: set[str]) -> None:
    """Equalities between sites: an anchor alone would be completed at q = 0, where loops may be open."""
    if chord.kind in ("slide", "distance"):
        problem = f"chord '{shortened(chord.name)}' is a {chord.kind}, which MuJoCo has no equality for"
        raise CannotSave(problem, "save model.opened, which is the tree without loops")
    shifts = {"": np.zeros(3), "_axis": np.array(chord.axis)} if chord.kind == "hinge" else {"": np.zeros(3)}
    for ending, shift in shifts.items():
        names = []
        for side, body, placement in (("i", chord.body_i, chord.placement_i), ("j", chord.body_j, chord.placement_j)):
            name = _free(f"{chord.name}{ending}_{side}", sites)
            sites.add(name)
            names.append(name)
            _site(elements[body], name, placement @ Placement(translation=shift))
        kind = "weld" if chord.kind == "weld" else "connect"
        etree.SubElement(equality, kind, name=f"{chord.name}{ending}", site1=names[0], site2=names[1])


def _add_motors(actuator: etree._Element, model: RobotModel) -> None:
    driven = model.independent_joints if model.actuated is None else model.actuated
    for joint in (joint for joint in model.joints if joint.name in driven):
        motor = etree.SubElement(actuator, "motor", name=joint.name, joint=joint.name)
        if joint.limits.effort:
            motor.set("ctrlrange", f"{-joint.limits.effort!r} {joint.limits.effort!r}")


def _site(element: etree._Element, name: str, placement: Placement) -> None:
    _place(etree.SubElement(element, "site", name=name), placement)


def _place(element: etree._Element, placement: Placement) -> None:
    if placement.translation.any():
        element.set("pos", text(placement.translation))
    if not np.array_equal(placement.rotation, np.eye(3)):
        from scipy.spatial.transform import Rotation  # imported where first used: help needs no scipy

        element.set("quat", text(Rotation.from_matrix(placement.rotation).as_quat(canonical=True, scalar_first=True)))


def _is_identity(placement: Placement) -> bool:
    return np.array_equal(placement.rotation, np.eye(3)) and not placement.translation.any()


def _free(wish: str, taken: set[str]) -> str:
    names: Iterator[str] = chain([wish], (f"{wish}_{k}" for k in count(1)))
    return next(name for name in names if name not in taken)
