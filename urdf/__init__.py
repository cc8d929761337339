"""URDF files and graphdyn: load, inspect, save, and a catalogue of robots.

Strict where parsers guess: what would have to be filled in is refused with file, line, element and remedy.
"""

from urdf.catalogue import RobotEntry, robots
from urdf.errors import (
    AxisNotNormalizedWarning,
    CannotSave,
    CannotUpdate,
    DuplicateEntry,
    GravityNotSavedWarning,
    InvalidLock,
    InvalidNumber,
    InvalidRobot,
    MalformedXML,
    MimicJointWarning,
    MissingEntry,
    MissingInertialWarning,
    NotATree,
    RobotNotFound,
    TooLarge,
    UnsupportedJoint,
    URDFError,
    URDFWarning,
)
from urdf.inspection import Finding, Report, inspect
from urdf.loading import fused_links, load
from urdf.saving import save
from urdf.updating import Update, update

__all__ = [
    "AxisNotNormalizedWarning",
    "CannotSave",
    "CannotUpdate",
    "DuplicateEntry",
    "Finding",
    "GravityNotSavedWarning",
    "InvalidLock",
    "InvalidNumber",
    "InvalidRobot",
    "MalformedXML",
    "MimicJointWarning",
    "MissingEntry",
    "MissingInertialWarning",
    "NotATree",
    "Report",
    "RobotEntry",
    "RobotNotFound",
    "TooLarge",
    "URDFError",
    "URDFWarning",
    "UnsupportedJoint",
    "Update",
    "fused_links",
    "inspect",
    "load",
    "robots",
    "save",
    "update",
]
