"""What is read from a source: urdf.load, urdf.shapes, urdf.fused_links, and a file as readers misunderstand it."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from numbers import Integral
from typing import TYPE_CHECKING, Unpack

from graphdyn import Body, Frame, InvalidInput, Joint, Placement, RobotModel
from graphdyn.layout import Array
from urdf.document.document import Document
from urdf.document.elements import GEOMETRIES, Geometry
from urdf.document.opening import Given
from urdf.document.tree import joints_in_order
from urdf.geometry.reading import placed_shapes
from urdf.geometry.shape import Shapes
from urdf.loops.mimics import unbound_dependents
from urdf.reading.fusing import assemble
from urdf.reading.parsing import build, parsed_source
from urdf.reading.reading import AS_IT_STANDS, Reading, ReadingKeywords
from urdf.reading.warnings import warn, warn_of_unbound

if TYPE_CHECKING:
    from yourdfpy.urdf import Robot


def load(source: Given, **reading: Unpack[ReadingKeywords]) -> RobotModel:
    """The robot of a URDF file, or of the catalog by name ("ur5", "kr500": see urdf.robots).

    source: name, path, XML as text or bytes, or an open file; a string is XML if it begins with "<" or has several
        lines. A path that ends with .xacro is expanded, which needs the extra graphdyn[xacro]; XML whose root is
        <mujoco> is MJCF, read by MuJoCo (extra graphdyn[mujoco]), with its gravity and the armature of its joints
    reading: chain, lock, mimic, loops, repair, gravity and xacro as keywords, explained at urdf.Reading; or one
        reading=urdf.Reading(…)

    Bodies are numbered parents first, depth first, siblings in the order of the <joint> elements; a body has the name
    of its link. Fixed and locked joints are fused and their links kept as frames, under the joint's name too unless a
    link has that name. Joints that mimic a locked joint are locked with it. Angles are used as written: 1.5708 is not
    π/2. The inertia of the root link, which never moves, is dropped. An effort or velocity limit that is the largest
    double means "none" (urdf.save writes it).

    Elements that close loops (<loop> of URDF+, <loop_joint>, <constraint>, <drake:ball_constraint>) become
    RobotModel.chords, <coupling> of URDF+ becomes a coupling. Others that join links or joints are refused. All are
    passed over where they constrain nothing: where one body carries all links that they name, or chain leaves all of
    them out. In a robot with loops, joints named by a <transmission> with an <actuator>, or by the YAML file, are
    actuated.

    Raises URDFError (RobotNotFound, MalformedXML, TooLarge, MissingEntry, DuplicateEntry, InvalidNumber,
    UnsupportedJoint, UnsupportedConstraint, InvalidLoop, NotATree, InvalidChain, InvalidLock, InvalidMimic,
    InvalidRepair, InvalidRobot, InvalidXacro, XacroNotInstalled, InvalidMJCF, MujocoNotInstalled) with file, line and
    element, also for every value that would have to be guessed, and InvalidModel for a gravity that is not three finite
    numbers.
    Warns MissingInertialWarning, ZeroMassWarning, AxisNotNormalizedWarning, MimicJointWarning, UnreadWarning,
    ChainWarning, RepairWarning, XacroWarning, UnboundJointWarning.

    >>> import urdf
    >>> model = urdf.load("ur5")  # or a path
    >>> model.joint_names
    ('shoulder_pan_joint', 'shoulder_lift_joint', 'elbow_joint', 'wrist_1_joint', 'wrist_2_joint', 'wrist_3_joint')
    >>> print(urdf.load("ur5", lock={"wrist_3_joint": 0.0}))
    robot ur5: 5 joints, 16.99 kg
    joints: shoulder_pan_joint, shoulder_lift_joint, elbow_joint, wrist_1_joint, wrist_2_joint
    bodies: world, shoulder_link, upper_arm_link, forearm_link, wrist_1_link, wrist_2_link
    """
    how = Reading.of(load, reading)
    document, reduced, parsed = parsed_source(source, how)
    model = armed(build(parsed, document.gravity), document)
    between = document.beyond.between if document.beyond is not None else frozenset()
    warn(parsed, model.gravity if how.gravity is None else None, document.complaints or (), between)
    warn_of_unbound(parsed, unbound_dependents(reduced, model))
    return model if how.gravity is None else model.with_gravity(how.gravity)


def armed(model: RobotModel, document: Document) -> RobotModel:
    """The model with the armature that an MJCF file states."""
    if document.beyond is None or not document.beyond.armature:
        return model
    armature = document.beyond.armature
    joints = tuple(replace(joint, armature=armature.get(joint.name, 0.0)) for joint in model.joints)
    return replace(model, joints=joints)


def fused_links(source: Given, **reading: Unpack[ReadingKeywords]) -> dict[str, tuple[int, Array]]:
    """What fixed links add to the bodies that carry them: by link name, number of the body and its share (10,).

    The share is in inertial parameters about the body's link origin, in its link axes: without the link, the body's
    parameters are `model.bodies[number - 1].parameters - share`. Links without <inertial> and links fixed to the
    ground are left out. Arguments and errors as in load; no warnings.
    """
    return parsed_source(source, Reading.of(fused_links, reading))[2].assembly.fused


def held_positions(source: Given, reading: Reading) -> Mapping[str, float]:
    """Position [rad or m] of each movable joint that stands still.

    These are locked joints, those beside a chain, and those that only such joints drive. Raises load's errors.
    """
    return parsed_source(source, reading)[2].locked


def shapes(
    source: Given,
    *,
    geometry: Geometry = "visual",
    faces: int | None = None,
    **reading: Unpack[ReadingKeywords],
) -> Shapes:
    """What a robot looks like: boxes, cylinders, spheres and mesh files as triangles, each on a body of the model.

    source, reading: as in load; the bodies are those of the model that load makes of them
    geometry: "visual" or "collision"
    faces: how many triangles all shapes may have together, about; None leaves them as they are

    Mesh files are STL, OBJ and Collada (.dae), in meters times their scale; a Collada file states its own unit.
    package://NAME/… is looked for beside the file and in every folder above it, then in ROS_PACKAGE_PATH and
    AMENT_PREFIX_PATH; other paths are relative to the file. Nothing is fetched. What cannot be shown is listed in
    .missing with the reason.

    Raises load's errors, and InvalidInput for another geometry or a number of faces that is none. Warns nothing.
    """
    if geometry not in GEOMETRIES:
        raise InvalidInput(f"geometry is {geometry!r}; give 'visual' or 'collision'")
    if faces is not None and (not isinstance(faces, Integral) or isinstance(faces, bool) or faces < 1):
        raise InvalidInput(f"faces is {faces!r}; give a whole number from 1 on, or None")
    document, elements, parsed = parsed_source(source, Reading.of(shapes, reading))
    model = build(parsed, document.gravity)
    names = (model.base_name, *model.body_names)
    own = (Frame(name, body, Placement()) for body, name in enumerate(names))
    places = {frame.name: (names[frame.body], frame.placement) for frame in (*model.frames, *own)}
    return placed_shapes(elements, geometry, places, faces)


class Misreadings:
    """What bodies and joints become when elements of a file are changed.

    robot: yourdfpy's, to look at; its joints in the order of `order`, names, parents first
    carriers: by name of each link with an <inertial> that is fixed to a body, the name of the body
    """

    def __init__(self, source: Given, reading: Reading = AS_IT_STANDS) -> None:
        _, elements, self._parsed = parsed_source(source, reading)
        self.robot: Robot = self._parsed.robot
        self.order = joints_in_order(elements)[1]
        assembly = self._parsed.assembly
        self.carriers = {
            name: assembly.bodies[number - 1].name for name, (number, share) in assembly.fused.items() if share.any()
        }

    def of(
        self, changes: Mapping[str, Callable[[Robot], object]]
    ) -> Iterator[tuple[str, tuple[Body, ...], tuple[Joint, ...]]]:
        """Numbers by name of the change: the bodies and joints after it; change(robot) alters a copy of the robot in
        place."""
        for name, change in changes.items():
            robot = _copied(self.robot)
            change(robot)
            assembly = assemble(robot, self._parsed.root, self.order, self._parsed.locked)
            yield name, tuple(assembly.bodies), tuple(assembly.joints)


def _copied(robot: Robot) -> Robot:
    """A copy whose links, inertials and joints can be given other attributes."""
    links = [copy.copy(link) for link in robot.links]
    for link in links:
        link.inertial = copy.copy(link.inertial)
    return replace(robot, links=links, joints=[copy.copy(joint) for joint in robot.joints])
