"""urdf.load: open a source, parse it, warn of what is doubtful, build the model."""

from __future__ import annotations

from collections.abc import Iterable

from numpy.typing import ArrayLike

from graphdyn import RobotModel
from graphdyn.layout import Array
from urdf.document.opening import Given, Xacro, open_document
from urdf.document.source import reduced
from urdf.loops.closing import Loops, stated_beside
from urdf.loops.mimics import Mimic
from urdf.reading.cutting import Chain
from urdf.reading.locking import Lock
from urdf.reading.parsing import build, parse
from urdf.reading.repairing import Repair
from urdf.reading.warnings import warn


def load(
    source: Given,
    *,
    chain: Chain = None,
    lock: Lock = None,
    mimic: Mimic = "coupled",
    loops: Loops = None,
    repair: Iterable[Repair] = (),
    gravity: ArrayLike | None = None,
    xacro: Xacro | None = None,
) -> RobotModel:
    """The robot of a URDF file, or of the catalogue by name ("ur5", "kr500": see urdf.robots).

    source: name, path, XML as text or bytes, or an open file; a string is XML if it begins with "<" or has several
        lines. A path that ends with .xacro is expanded, which needs the extra graphdyn[xacro]
    chain: (base_link, tip_link) cuts out the arm between two links; base_link becomes the root, at the origin.
        Links fixed to the path stay. Other movable joints are locked where the path carries them (at 0 unless lock
        says otherwise), because the arm carries their mass; on base_link itself they are left out
    lock: joints to hold still: {name: value [rad or m]}, or names (value 0)
    mimic: what becomes of mimic joints: "coupled" ties them to the joint that they mimic, and q, v, a and tau have no
        entries for them (RobotModel.couplings); "independent" makes each a joint of its own, as Pinocchio does by
        default; "locked" holds them at 0, or where lock says
    loops: loops that the file itself does not state: a sequence of urdf.Loop, or the path of a YAML file as the package
        example-parallel-robots has them. Default: the YAML file of that form that stands beside the URDF and has its
        name (arm.urdf, arm.yaml), if there is one; loops=() leaves it unread
    repair: what to repair, each change reported by RepairWarning: "axis" gives unit length to axes whose length
        differs from 1 by less than 1e-3, "limits" exchanges lower and upper limits that are reversed,
        InertialsFromMeshes(density=…) computes missing inertials from the shapes of their links
    gravity: (3,) in world axes [m/s²]; default: the catalogue's for a name, (0, 0, -9.81) for a file
    xacro: arguments and packages for a .xacro file

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
    InvalidRepair, InvalidRobot, InvalidXacro, XacroNotInstalled) with file, line and element, also for every value that
    would have to be guessed, and InvalidModel for a gravity that is not three finite numbers.
    Warns MissingInertialWarning, AxisNotNormalizedWarning, MimicJointWarning, UnreadWarning, ChainWarning,
    RepairWarning, XacroWarning.
    """
    opened = open_document(source, xacro)
    beside = stated_beside(loops, opened.document.path)
    parsed = parse(reduced(opened.document), beside, chain=chain, lock=lock, mimic=mimic, repair=repair)
    model = build(parsed, opened.gravity)
    warn(parsed, model.gravity if gravity is None else None, opened.complaints or ())
    return model if gravity is None else model.with_gravity(gravity)


def fused_links(
    source: Given,
    *,
    chain: Chain = None,
    lock: Lock = None,
    mimic: Mimic = "coupled",
    repair: Iterable[Repair] = (),
    xacro: Xacro | None = None,
) -> dict[str, tuple[int, Array]]:
    """What fixed links add to the bodies that carry them: by link name, number of the body and its share (10,).

    The share is in inertial parameters about the body's link origin, in its link axes: without the link, the body's
    parameters are `model.bodies[number - 1].parameters - share`. Links without <inertial> and links fixed to the
    ground are left out. Arguments and errors as in load; no warnings.
    """
    opened = open_document(source, xacro)
    return parse(reduced(opened.document), chain=chain, lock=lock, mimic=mimic, repair=repair).assembly.fused
