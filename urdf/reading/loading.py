"""urdf.load: open a source, parse it, warn of what is doubtful, build the model."""

from __future__ import annotations

from typing import Unpack

from graphdyn import RobotModel
from graphdyn.layout import Array
from urdf.document.opening import Given
from urdf.reading.parsing import build, parsed_source
from urdf.reading.reading import Reading, ReadingKeywords
from urdf.reading.warnings import warn


def load(source: Given, **reading: Unpack[ReadingKeywords]) -> RobotModel:
    """The robot of a URDF file, or of the catalog by name ("ur5", "kr500": see urdf.robots).

    source: name, path, XML as text or bytes, or an open file; a string is XML if it begins with "<" or has several
        lines. A path that ends with .xacro is expanded, which needs the extra graphdyn[xacro]
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
    InvalidRepair, InvalidRobot, InvalidXacro, XacroNotInstalled) with file, line and element, also for every value that
    would have to be guessed, and InvalidModel for a gravity that is not three finite numbers.
    Warns MissingInertialWarning, AxisNotNormalizedWarning, MimicJointWarning, UnreadWarning, ChainWarning,
    RepairWarning, XacroWarning.
    """
    how = Reading.of(load, reading)
    opened, _, parsed = parsed_source(source, how)
    model = build(parsed, opened.gravity)
    warn(parsed, model.gravity if how.gravity is None else None, opened.complaints or ())
    return model if how.gravity is None else model.with_gravity(how.gravity)


def fused_links(source: Given, **reading: Unpack[ReadingKeywords]) -> dict[str, tuple[int, Array]]:
    """What fixed links add to the bodies that carry them: by link name, number of the body and its share (10,).

    The share is in inertial parameters about the body's link origin, in its link axes: without the link, the body's
    parameters are `model.bodies[number - 1].parameters - share`. Links without <inertial> and links fixed to the
    ground are left out. Arguments and errors as in load; no warnings.
    """
    return parsed_source(source, Reading.of(fused_links, reading))[2].assembly.fused
