"""Bodies and joints of MuJoCo as links and joints of URDF.

A body of MuJoCo may turn about several axes that need not pass through its origin, and its joints count from their
`ref`. With T the placement of the body at q = ref, and p, a the anchor and axis of a joint in the body's axes, MuJoCo
computes T ← T · Trans(p) · Motion(a, q − ref) · Trans(−p), joint after joint (documentation, chapter Computation, and
mj_kinematics). A link of URDF moves about its own origin: each joint gets a link at its anchor, and the frame of the
body follows from the last one.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain, count

import numpy as np
from lxml import etree

from graphdyn import Body, Placement
from graphdyn.layout import Array
from graphdyn.model import rotation_about
from urdf.document.mjcf.merging import Merged, Place
from urdf.document.mjcf.native import Native
from urdf.document.numbers import NO_LIMIT, add_numbers, add_placement, inertial_element, text
from urdf.errors import InvalidMJCF, shortened

WORLD = "world"

Mimic = tuple[str, float, float]
"""Driving joint, ratio and offset."""


class Tree:
    """The links and joints of a compiled robot.

    places: where elements are written; links: name of the link in which a body's frame lies, by its number
    gravity: (3,) [m/s²]; armature: by joint; between: names of links without mass between joints of one body
    """

    def __init__(
        self, native: Native, whole: Merged, held: Mapping[int, float], couplings: Mapping[int, Mimic]
    ) -> None:
        """held: joints that stand still, by number [rad or m]; couplings: joints that others drive, by number."""
        self._native, self._whole, self._held, self._couplings = native, whole, held, couplings
        self._model = model = native.model
        self.places: dict[etree._Element, Place] = {}
        self.links = {0: WORLD}
        self.between: list[str] = []
        disabled = int(model.opt.disableflags) & int(native.mujoco.mjtDisableBit.mjDSBL_GRAVITY)
        x, y, z = (0.0, 0.0, 0.0) if disabled else map(float, model.opt.gravity)
        self.gravity = x, y, z
        joints = range(model.njnt)
        inertia = {j: float(model.dof_armature[model.jnt_dofadr[j]]) for j in joints if j not in held}
        self.armature = {model.joint(j).name: value for j, value in inertia.items() if value}
        names = [model.body(i).name for i in range(model.nbody)]
        self._link_names, self._joint_names = {WORLD, *names}, {model.joint(j).name for j in joints}
        self._effort = self._efforts()

    def robot(self, name: str) -> etree._Element:
        """<robot> with all links and joints."""
        robot, model = etree.Element("robot", name=name), self._model
        etree.SubElement(robot, "link", name=WORLD)
        for number in range(1, model.nbody):
            self._add_body(robot, number)
        for number in range(model.nsite):
            site = model.site(number).name
            if site:
                link = self._new_link(site)
                placement = Placement(self._rotation(model.site_quat[number]), model.site_pos[number])
                place = self._whole.place("site", site)
                self._fix(robot, self.links[int(model.site_bodyid[number])], link, placement, place)
                self.add(robot, etree.Element("link", name=link), place)
        return robot

    def add(self, robot: etree._Element, element: etree._Element, place: Place) -> None:
        """Append an element that is written at this place, with all that is in it."""
        robot.append(element)
        for each in element.iter(etree.Element):
            self.places[each] = place

    def site(self, number: int) -> tuple[str, Placement]:
        """Link and placement of a site."""
        model = self._model
        placement = Placement(self._rotation(model.site_quat[number]), model.site_pos[number])
        return self.links[int(model.site_bodyid[number])], placement

    def _add_body(self, robot: etree._Element, number: int) -> None:
        model = self._model
        name, parent = model.body(number).name, self.links[int(model.body_parentid[number])]
        place = self._place("body", name)
        placement = Placement(self._rotation(model.body_quat[number]), model.body_pos[number])
        first, joints = int(model.body_jntadr[number]), int(model.body_jntnum[number])
        anchor = np.zeros(3)
        for j in range(first, first + joints):
            here = model.jnt_pos[j]
            placement = placement @ Placement(translation=here - anchor)
            anchor = here
            is_body = j == first + joints - 1 and not anchor.any()
            link = name if is_body else self._new_link(f"{name}/{model.joint(j).name}")
            self._add_joint(robot, j, parent, link, placement)
            if not is_body:
                self.add(robot, etree.Element("link", name=link), place)
                if j < first + joints - 1:
                    self.between.append(link)
            parent, placement = link, Placement()
        if not joints or anchor.any():
            self._fix(robot, parent, name, placement @ Placement(translation=-anchor), place)
        self.links[number] = name
        link_element = etree.Element("link", name=name)
        if model.body_mass[number] > 0 and name not in self._native.without_inertial:
            link_element.append(inertial_element(self._body(number)))
        self.add(robot, link_element, place)

    def _body(self, number: int) -> Body:
        model = self._model
        axes = self._rotation(model.body_iquat[number])
        tensor = axes @ np.diag(model.body_inertia[number]) @ axes.T
        name, mass = model.body(number).name, float(model.body_mass[number])
        return Body(name, mass, model.body_ipos[number], (tensor + tensor.T) / 2)

    def _add_joint(self, robot: etree._Element, j: int, parent: str, child: str, placement: Placement) -> None:
        model = self._model
        slides = int(model.jnt_type[j]) == int(self._native.mujoco.mjtJoint.mjJNT_SLIDE)
        name, axis, ref = model.joint(j).name, model.jnt_axis[j], float(model.qpos0[model.jnt_qposadr[j]])
        place = self._place("joint", name)
        if j in self._held:
            self._fix(robot, parent, child, placement @ _motion(axis, self._held[j] - ref, slides), place, name)
            return
        lower, upper = map(float, model.jnt_range[j]) if model.jnt_limited[j] else (-NO_LIMIT, NO_LIMIT)
        limited = bool(model.jnt_limited[j])
        kind = "prismatic" if slides else "revolute" if limited else "continuous"
        joint = self._joint(name, kind, parent, child, placement @ _motion(axis, -ref, slides))
        etree.SubElement(joint, "axis", xyz=text(axis))
        bounds = {"effort": self._effort.get(name, NO_LIMIT), "velocity": NO_LIMIT}
        if kind != "continuous":
            bounds = {"lower": lower, "upper": upper, **bounds}
        add_numbers(joint, "limit", bounds)
        dof = model.jnt_dofadr[j]
        if model.dof_armature[dof] < 0:
            file, line = place
            problem = f"armature is {model.dof_armature[dof]:g}"
            element = f"joint '{shortened(name)}'"
            raise InvalidMJCF(problem, "give the inertia of the rotor, or 0", path=file, line=line, element=element)
        damping, friction = float(model.dof_damping[dof]), float(model.dof_frictionloss[dof])
        if damping or friction:
            add_numbers(joint, "dynamics", {"damping": damping, "friction": friction})
        if j in self._couplings:
            driver, ratio, offset = self._couplings[j]
            etree.SubElement(joint, "mimic", joint=driver, multiplier=repr(ratio), offset=repr(offset))
        self.add(robot, joint, place)

    def _fix(
        self, robot: etree._Element, parent: str, child: str, placement: Placement, place: Place, name: str = ""
    ) -> None:
        if not name:
            name = _free(f"{child}_fixed", self._joint_names)
            self._joint_names.add(name)
        self.add(robot, self._joint(name, "fixed", parent, child, placement), place)

    def _joint(self, name: str, kind: str, parent: str, child: str, placement: Placement) -> etree._Element:
        joint = etree.Element("joint", name=name, type=kind)
        add_placement(joint, placement)
        etree.SubElement(joint, "parent", link=parent)
        etree.SubElement(joint, "child", link=child)
        return joint

    def _efforts(self) -> dict[str, float]:
        """Limits of the force at joints: of the joint, or of the only actuator that drives it."""
        model = self._model
        found: dict[str, float] = {}
        driven = [actuator.joint for actuator in self._native.actuators]
        for actuator in self._native.actuators:
            if actuator.effort is not None and driven.count(actuator.joint) == 1:
                found[actuator.joint] = actuator.effort
        for j in range(model.njnt):
            if model.jnt_actfrclimited[j]:
                found[model.joint(j).name] = max(abs(float(bound)) for bound in model.jnt_actfrcrange[j])
        return found

    def _rotation(self, quaternion: Array) -> Array:
        """(3, 3) of a unit quaternion (w, x, y, z), to rounding orthonormal."""
        w, x, y, z = (float(one) for one in quaternion / np.linalg.norm(quaternion))
        return np.array(
            [
                [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
            ]
        )

    def _new_link(self, wish: str) -> str:
        name = _free(wish, self._link_names)
        self._link_names.add(name)
        return name

    def _place(self, kind: str, name: str) -> Place:
        return self._whole.place(kind, name, self._native.lines.get((kind, name), ""))


def _motion(axis: Array, value: float, slides: bool) -> Placement:
    if value == 0:
        return Placement()
    return Placement(translation=value * axis) if slides else Placement(rotation_about(axis, value))


def _free(wish: str, taken: set[str]) -> str:
    """The wanted name, or the first of wish_1, wish_2, … that is not taken."""
    return next(name for name in chain([wish], (f"{wish}_{k}" for k in count(1))) if name not in taken)
