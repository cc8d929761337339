"""The stages between the document and the model: repair, check, cut, parse, fuse."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from lxml import etree
from numpy.typing import ArrayLike

from graphdyn import Coupling, InvalidModel, RobotModel
from urdf._assembly import Assembly, assemble
from urdf._checks import check
from urdf._cutting import Chain, Cut, cut
from urdf._errors import InvalidRobot
from urdf._extensions import Unread, closure_faults
from urdf._locking import Lock, locked_values
from urdf._mimics import Mimic, resolve
from urdf._repairing import repair as mend
from urdf._source import Source
from urdf._tree import carriers, check_tree, joints_in_order

if TYPE_CHECKING:
    import yourdfpy


@dataclass(frozen=True, eq=False)
class Parsed:
    """A file as yourdfpy reads it, and the bodies, joints and frames made of it.

    locked: value per locked joint [rad or m]; stated: those of them that the caller named
    couplings: of mimic joints
    changes: the repairs, in words; unread: what of the file is not read and should be known
    """

    path: Path
    robot: yourdfpy.urdf.Robot
    root: str
    cut: Cut
    locked: Mapping[str, float]
    stated: frozenset[str]
    couplings: tuple[Coupling, ...]
    changes: tuple[str, ...]
    unread: tuple[Unread, ...]
    assembly: Assembly


def parse(
    source: Source,
    *,
    chain: Chain = None,
    lock: Lock = None,
    mimic: Mimic = "coupled",
    repair: Iterable[str] = (),
) -> Parsed:
    """The stages between the document and the model; the source is modified. Raises as load does."""
    path = source.path
    changes = mend(source, repair)
    check(source)
    check_tree(source)
    beside = cut(source, chain)
    root, order = joints_in_order(source)
    robot = _robot(source)
    movable = [joint.name for joint in robot.joints if joint.type != "fixed"]
    stated = locked_values(lock, movable, path)
    mimics = resolve(source, robot, mimic, dict.fromkeys(beside.held, 0.0) | stated, stated)
    locked = mimics.locked
    for fault in closure_faults(source.extensions.closures, carriers(source, locked), path):
        raise fault
    if not set(movable) - set(locked):
        raise InvalidRobot(
            "no moving body: every joint is fixed or locked", "leave a joint free", code="no-moving-joint", path=path
        )
    try:
        assembly = assemble(robot, root, order, locked)
    except InvalidModel as error:
        raise InvalidRobot(str(error), "correct the file", path=path) from error
    unread = source.extensions.unread
    return Parsed(
        path, robot, root, beside, locked, frozenset(stated), mimics.couplings, tuple(changes), unread, assembly
    )


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
            couplings=parsed.couplings,
        )
    except InvalidModel as error:
        raise InvalidRobot(str(error), "correct the file", path=parsed.path) from error


def _robot(source: Source) -> yourdfpy.urdf.Robot:
    """yourdfpy's robot of exactly the elements that were checked. Imported here, because that takes a second."""
    import yourdfpy

    document = BytesIO(etree.tostring(source.robot, encoding="utf-8"))  # ASCII cannot hold the tag <größe>
    return yourdfpy.URDF.load(document, build_scene_graph=False, load_meshes=False).robot
