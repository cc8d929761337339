"""URDF file → RobotModel: find, check, parse, fuse. Each stage is one file of this package."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from lxml import etree
from numpy.typing import ArrayLike

from graphdyn import InvalidModel, RobotModel
from graphdyn.layout import Array
from urdf.assembly import Assembly, assemble
from urdf.catalogue import locate
from urdf.checks import check
from urdf.errors import AxisNotNormalizedWarning, InvalidRobot, MimicJointWarning, MissingInertialWarning
from urdf.locking import Lock, locked_values
from urdf.source import Source, read
from urdf.tree import joints_in_order

if TYPE_CHECKING:
    import yourdfpy

UNIT_LENGTH = 1e-9
"""An axis whose length differs from 1 by more than this is normalised with a warning."""


def load(path_or_name: str | PathLike[str], *, lock: Lock = None, gravity: ArrayLike | None = None) -> RobotModel:
    """The robot of a URDF file, or of the catalogue by name ("ur5", "kr500": see urdf.robots).

    lock: joints to hold still: {name: value [rad or m]}, or names (value 0)
    gravity: (3,) in world axes [m/s²]; default: the catalogue's for a name, (0, 0, -9.81) for a file

    Bodies are numbered parents first, depth first, siblings in the order of the <joint> elements; a body has the name
    of its link. Fixed and locked joints are fused and their links kept as frames, under the joint's name too unless a
    link has that name. Angles are used as written: 1.5708 is not π/2. The inertia of the root link, which never moves,
    is dropped. A largest-double effort or velocity limit means "none" (urdf.save writes it).

    Raises URDFError (RobotNotFound, MalformedXML, TooLarge, MissingEntry, DuplicateEntry, InvalidNumber,
    UnsupportedJoint, NotATree, InvalidLock, InvalidRobot) with file, line and element for everything that would have to
    be guessed, and InvalidModel for a gravity that is not three finite numbers.
    Warns MissingInertialWarning, AxisNotNormalizedWarning, MimicJointWarning.
    """
    path, default_gravity = locate(path_or_name)
    source = read(path)
    check(source)
    parsed = parse(source, lock)
    model = build(parsed, default_gravity)
    _warn(path, parsed)
    return model if gravity is None else model.with_gravity(gravity)


def fused_links(path_or_name: str | PathLike[str], *, lock: Lock = None) -> dict[str, tuple[int, Array]]:
    """What fixed links add to the bodies that carry them: by link name, number of the body and its share (10,).

    The share is in inertial parameters about the body's link origin, in its link axes: without the link, the body's
    parameters are `model.bodies[number - 1].parameters - share`. Links without <inertial> and links fixed to the
    ground are left out. lock and errors as in load; no warnings.
    """
    source = read(locate(path_or_name)[0])
    check(source)
    return parse(source, lock).assembly.fused


@dataclass(frozen=True, eq=False)
class Parsed:
    """A file as yourdfpy reads it, and the bodies, joints and frames made of it."""

    path: Path
    robot: yourdfpy.urdf.Robot
    root: str
    locked: Mapping[str, float]
    assembly: Assembly


def parse(source: Source, lock: Lock = None) -> Parsed:
    """The stages between the checks and the model. Raises NotATree, InvalidLock, InvalidRobot."""
    path = source.path
    root, order = joints_in_order(source)
    robot = _robot(source)
    movable = [joint.name for joint in robot.joints if joint.type != "fixed"]
    locked = locked_values(lock, movable, path)
    if not set(movable) - set(locked):
        raise InvalidRobot(
            "no moving body: every joint is fixed or locked", "leave a joint free", code="no-moving-joint", path=path
        )
    try:
        return Parsed(path, robot, root, locked, assemble(robot, root, order, locked))
    except InvalidModel as error:
        raise InvalidRobot(str(error), "correct the file", path=path) from error


def build(parsed: Parsed, gravity: ArrayLike) -> RobotModel:
    """The model, under this gravity (3,) [m/s²]. Raises InvalidRobot."""
    try:
        return RobotModel(
            parsed.robot.name,
            tuple(parsed.assembly.bodies),
            tuple(parsed.assembly.joints),
            gravity=np.array(gravity),
            base_name=parsed.root,
            frames=tuple(parsed.assembly.frames),
        )
    except InvalidModel as error:
        raise InvalidRobot(str(error), "correct the file", path=parsed.path) from error


def _robot(source: Source) -> yourdfpy.urdf.Robot:
    """yourdfpy's robot of exactly the elements that were checked. Its import takes a second, hence here."""
    import yourdfpy

    document = BytesIO(etree.tostring(source.robot, encoding="utf-8"))  # ASCII has no names such as <größe>
    return yourdfpy.URDF.load(document, build_scene_graph=False, load_meshes=False).robot


def _warn(path: Path, parsed: Parsed) -> None:
    """The three warnings, each once per file with all names, at the line that called load."""
    robot, locked, assembly = parsed.robot, parsed.locked, parsed.assembly
    lengths = {joint.name: float(np.linalg.norm(joint.axis)) for joint in robot.joints if joint.type != "fixed"}
    odd = [f"joint '{name}' ({length:.9g})" for name, length in lengths.items() if abs(length - 1) > UNIT_LENGTH]
    if odd:
        warnings.warn(
            f"{path}: axis not of unit length, normalised: {', '.join(odd)}", AxisNotNormalizedWarning, stacklevel=3
        )
    mimics = [f"'{joint.name}'" for joint in robot.joints if joint.mimic is not None and joint.name not in locked]
    if mimics:
        warnings.warn(
            f"{path}: mimic joints are loaded as independent joints: {', '.join(mimics)}; lock= holds them still",
            MimicJointWarning,
            stacklevel=3,
        )
    if assembly.massless:
        links = ", ".join(f"'{name}'" for names in assembly.massless for name in names)
        warnings.warn(
            f"{path}: moving links without <inertial>: {links}; their mass is zero and forward dynamics are not "
            "determined",
            MissingInertialWarning,
            stacklevel=3,
        )
