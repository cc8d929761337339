"""The stages between the document and the model: repair, check, cut, parse, fuse."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from lxml import etree
from numpy.typing import ArrayLike

from graphdyn import Chord, Coupling, InvalidModel, RobotModel
from urdf.document.connections.loops import CompanionFiles, Unread
from urdf.document.document import Document
from urdf.document.opening import Given, open_document
from urdf.document.source import Source, reduced
from urdf.document.tree import carriers, joints_in_order, tree_faults
from urdf.errors import InvalidRobot
from urdf.loops.closing import all_closures, chords, closure_faults, stated_beside
from urdf.loops.mimics import actuated, check_marks, check_motors, resolve, unread_motors
from urdf.reading.checks import faults
from urdf.reading.cutting import Cut, cut, locked_values
from urdf.reading.fusing import Assembly, assemble
from urdf.reading.reading import Reading
from urdf.reading.repairing import repair as mend
from urdf.reading.repairing import uses_geoms

if TYPE_CHECKING:
    import yourdfpy


@dataclass(frozen=True, eq=False)
class Parsed:
    """A file as yourdfpy reads it, and the bodies, joints and frames made of it.

    locked: value per locked joint [rad or m]; stated: those of them that the caller named
    couplings: of mimic joints and <coupling> elements; chords: of the loops; actuated: the joints that have motors,
        where there are chords and the file says it
    changes: the repairs, in words; unread: what of the file is not read and should be known
    """

    path: Path
    robot: yourdfpy.urdf.Robot
    root: str
    cut: Cut
    locked: Mapping[str, float]
    stated: frozenset[str]
    couplings: tuple[Coupling, ...]
    chords: tuple[Chord, ...]
    actuated: tuple[str, ...] | None
    changes: tuple[str, ...]
    unread: tuple[Unread, ...]
    assembly: Assembly


def parsed_source(given: Given, reading: Reading) -> tuple[Document, Source, Parsed]:
    """A source through all stages, with its elements as they are after repairs and cuts. Raises as load does."""
    document = open_document(given, reading.xacro, uses_geoms(reading.repair))
    source = reduced(document)
    return document, source, parse(source, stated_beside(reading.loops, document.path), reading)


def parse(source: Source, beside: CompanionFiles, reading: Reading) -> Parsed:
    """The stages between the document and the model; the source is modified. Raises as load does.

    beside: what is stated beside the file about loops
    """
    path = source.path
    changes = mend(source, reading.repair)
    for fault in chain(faults(source), tree_faults(source)):
        raise fault
    closures = all_closures(source, beside)
    check_marks(source)
    check_motors(source, beside)
    around = cut(source, reading.chain)
    root, order = joints_in_order(source)
    robot = _robot(source)
    movable = [joint.name for joint in robot.joints if joint.type != "fixed"]
    stated = locked_values(reading.lock, movable, path)
    mimics = resolve(source, robot, order, closures, reading.mimic, dict.fromkeys(around.held, 0.0) | stated, stated)
    locked = mimics.locked
    carried = carriers(source, locked)
    held = None if reading.chain is None else [name for name in around.held if name in locked and name not in stated]
    for fault in closure_faults(closures, carried, source, held):
        raise fault
    if not set(movable) - set(locked):
        raise InvalidRobot(
            "no moving body: every joint is fixed or locked", "leave a joint free", code="no-moving-joint", path=path
        )
    try:
        assembly = assemble(robot, root, order, locked)
    except InvalidModel as error:
        raise InvalidRobot(str(error), "correct the file", path=path) from error
    closing = tuple(chords(closures, carried, assembly.locations))
    motors = (*source.extensions.motors, *beside.motors) if closing else ()
    driven = {coupling.joint for coupling in mimics.couplings}
    return Parsed(
        path=path,
        robot=robot,
        root=root,
        cut=around,
        locked=locked,
        stated=frozenset(stated),
        couplings=mimics.couplings,
        chords=closing,
        actuated=actuated(motors, [joint.name for joint in assembly.joints if joint.name not in driven]),
        changes=tuple(changes),
        unread=(*source.extensions.unread, *beside.unread, *unread_motors(motors, driven)),
        assembly=assembly,
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
            chords=parsed.chords,
            actuated=parsed.actuated,
        )
    except InvalidModel as error:
        raise InvalidRobot(str(error), "correct the file", path=parsed.path) from error


def _robot(source: Source) -> yourdfpy.urdf.Robot:
    """yourdfpy's robot of exactly the elements that were checked. Imported here, because that takes a second."""
    import yourdfpy

    document = BytesIO(etree.tostring(source.robot, encoding="utf-8"))  # ASCII cannot hold the tag <größe>
    return yourdfpy.URDF.load(document, build_scene_graph=False, load_meshes=False).robot
