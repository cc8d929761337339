"""The warnings of urdf.load: each kind once per file, with all names."""

from __future__ import annotations

import math
import warnings
from collections.abc import Container, Sequence

import numpy as np

from graphdyn.layout import Array
from urdf.document.connections.loops import Unread
from urdf.document.numbers import UNIT_LENGTH_TOLERANCE, rotation_from_rpy, values
from urdf.errors import (
    MAX_QUOTED_NAMES,
    AxisNotNormalizedWarning,
    ChainWarning,
    MimicJointWarning,
    MissingInertialWarning,
    RepairWarning,
    UnboundJointWarning,
    UnreadWarning,
    URDFWarning,
    XacroWarning,
    ZeroMassWarning,
    one_line,
    shortened,
)
from urdf.reading.cutting import Cut
from urdf.reading.parsing import Parsed

MISSING_LOOPS = (
    "the loops, couplings or mimic joints that they would follow from are missing: state them in the file, in the YAML "
    "file of its name beside it, or as loops= (--loops)"
)

GRAVITY_TILT_TOLERANCE = 1e-9
"""Relative difference of gravity between the axes of the base link and of the root beyond which the base is tilted."""


def warn(parsed: Parsed, gravity: Array | None, complaints: Sequence[str], between: Container[str] = ()) -> None:
    """Issue the warnings, at the line that called load.

    gravity: of the model, None where the caller gave it (3,) [m/s²]; complaints: warnings of the expander of .xacro
    between: links without mass that are meant to have none, between joints of one body of an MJCF file
    """
    _tell(XacroWarning, parsed, "expanding the file: ", complaints)
    unread = [_at(unread, str(parsed.path)) for unread in parsed.unread[:MAX_QUOTED_NAMES]]
    more = f" and {len(parsed.unread) - MAX_QUOTED_NAMES} more" if len(parsed.unread) > MAX_QUOTED_NAMES else ""
    _tell(UnreadWarning, parsed, "not read: ", unread, more)
    joints, cut, assembly = parsed.robot.joints, parsed.cut, parsed.assembly
    _tell(RepairWarning, parsed, "repaired: ", parsed.changes)
    held = [f"'{name}'" for name in cut.held if parsed.locked.get(name) == 0 and name not in parsed.stated]
    after = "; the chain carries their links; lock= (--lock) locks them at other values"
    _tell(ChainWarning, parsed, "movable joints beside the chain are locked at 0: ", held, after)
    left_out = [f"'{name}'" for name in cut.left_out]
    after = "; the base link supports what they carry, not the chain"
    _tell(ChainWarning, parsed, "movable joints on the base of the chain are left out: ", left_out, after)
    if gravity is not None:
        _tell(ChainWarning, parsed, "", _tilt(cut, parsed.root, gravity))
    lengths = {joint.name: math.hypot(*joint.axis) for joint in joints if joint.type != "fixed"}
    odd = [
        f"joint '{name}' ({length:.9g})" for name, length in lengths.items() if abs(length - 1) > UNIT_LENGTH_TOLERANCE
    ]
    _tell(AxisNotNormalizedWarning, parsed, "axis not of unit length, normalized: ", odd)
    aside = {*parsed.locked, *(coupling.joint for coupling in parsed.couplings)}
    mimics = [f"'{joint.name}'" for joint in joints if joint.mimic is not None and joint.name not in aside]
    _tell(
        MimicJointWarning,
        parsed,
        "mimic joints are loaded as independent joints: ",
        mimics,
        "; lock= (--lock) locks them",
    )
    massless = [f"'{name}'" for names in assembly.massless for name in names if name not in between]
    after = "; their mass is zero and forward dynamics are not determined"
    _tell(MissingInertialWarning, parsed, "moving links without <inertial>: ", massless, after)
    weightless = [f"'{name}'" for names in assembly.weightless for name in names]
    _tell(ZeroMassWarning, parsed, "moving links of mass zero: ", weightless, "; they have no weight")


def warn_of_unbound(parsed: Parsed, joints: Sequence[str]) -> None:
    """Issue the warning about joints that are marked as dependent and move by themselves."""
    _tell(
        UnboundJointWarning,
        parsed,
        'joints marked independent="false" move by themselves: ',
        [f"'{shortened(name)}'" for name in joints],
        f"; {MISSING_LOOPS}",
    )


def _at(unread: Unread, read: str) -> str:
    """read: the file, which the warning names anyway"""
    where = f" of {unread.file}" if unread.file not in (None, read) else ""
    return unread.problem if unread.line is None else f"line {unread.line}{where}: {unread.problem}"


def _tilt(cut: Cut, base: str, gravity: Array) -> list[str]:
    """Gravity in the axes of the base link, if the link is tilted in the whole robot with all joints at 0."""
    rotation = np.eye(3)
    for joint in cut.before:
        rotation = rotation_from_rpy(*(values(joint.find("origin"), "rpy", 3) or (0.0, 0.0, 0.0))) @ rotation
    there = rotation.T @ gravity
    if np.abs(there - gravity).max() <= GRAVITY_TILT_TOLERANCE * np.abs(gravity).max():
        return []
    said = ", ".join(f"{x:.9g}" for x in there + 0.0)
    return [
        f"base link '{base}' is tilted in the whole robot, but upright as the root of the chain; "
        f"gravity=({said}) restores the direction that gravity has in the whole robot with all joints at 0"
    ]


def _tell(kind: type[URDFWarning], parsed: Parsed, before: str, items: Sequence[str], after: str = "") -> None:
    """One warning with all items; none where there are no items."""
    if items:
        warnings.warn(one_line(f"{parsed.path}: {before}{', '.join(items)}{after}"), kind, stacklevel=4)
