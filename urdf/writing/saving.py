"""RobotModel → URDF file, written by ourselves.

yourdfpy's writer computes roll and yaw separately, from entries of the rotation that vanish at pitch = ±π/2. With the
rounding of one matrix product in the entries, the angles it writes miss the rotation by up to 0.37 within 1e-15 rad of
that pitch, 5e-5 within 1e-8, 1e-8 within 1e-4 (20000 random rotations each); rpy_from_rotation by 8e-16 at most.
"""

from __future__ import annotations

import warnings
from os import PathLike
from pathlib import Path

import numpy as np
from lxml import etree

from graphdyn import RobotModel
from graphdyn.model import STANDARD_GRAVITY, check_model
from urdf.document.files import write_whole
from urdf.errors import GravityNotSavedWarning, one_line
from urdf.writing.writing import robot_element


def save(model: RobotModel, path: str | PathLike[str]) -> None:
    """Write the model as URDF; urdf.load gives it back, to rounding.

    The order of bodies comes back if they are numbered depth first, as load does. A frame becomes a link on a fixed
    joint that is named after its first alias. A base placement becomes a root link "world" with a fixed joint. A
    missing effort or velocity limit is written as the largest double (limits.NO_LIMIT); a continuous joint has no
    position limits. A body without mass and inertia gets no <inertial>. Chords become <loop> elements of URDF+, joints
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
