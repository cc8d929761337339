"""URDF files and graphdyn: load, inspect, save, and a catalog of robots.

Strict where other parsers guess: a missing value is refused, with file, line, element and remedy.
"""

from urdf.document.catalog import RobotEntry, robots
from urdf.document.connections.loops import Loop
from urdf.document.dh import CONVENTIONS, DHLink, DHRow, DHTable
from urdf.document.opening import Xacro
from urdf.errors import (
    AxisNotNormalizedWarning,
    CannotSave,
    CannotUpdate,
    ChainWarning,
    DuplicateEntry,
    GravityNotSavedWarning,
    InvalidChain,
    InvalidDH,
    InvalidLock,
    InvalidLoop,
    InvalidMimic,
    InvalidMJCF,
    InvalidNumber,
    InvalidRepair,
    InvalidRobot,
    InvalidXacro,
    MalformedXML,
    MimicJointWarning,
    MissingEntry,
    MissingInertialWarning,
    MujocoNotInstalled,
    NotATree,
    RepairWarning,
    RobotNotFound,
    TooLarge,
    UnboundJointWarning,
    UnreadWarning,
    UnsupportedConstraint,
    UnsupportedJoint,
    URDFError,
    URDFWarning,
    XacroNotInstalled,
    XacroWarning,
    ZeroMassWarning,
)
from urdf.geometry.shape import MissingShape, Shape, Shapes
from urdf.inspection import Finding, Inspection, inspect
from urdf.reading.loading import fused_links, load, shapes
from urdf.reading.mesh_inertials import InertialsFromMeshes
from urdf.reading.reading import Reading, ReadingKeywords
from urdf.reading.written import (
    WrittenInertial,
    WrittenJoint,
    WrittenMimic,
    WrittenOrigin,
    WrittenRobot,
    written,
)
from urdf.writing.dh import dh_table, save_dh
from urdf.writing.mjcf.patching import Patch, patch_mjcf
from urdf.writing.mjcf.saving import save_mjcf
from urdf.writing.repaired_file import REPAIRED_CODES, RepairedFile, repair
from urdf.writing.updating import Update, update
from urdf.writing.writing import save

__all__ = [
    "CONVENTIONS",
    "REPAIRED_CODES",
    "AxisNotNormalizedWarning",
    "CannotSave",
    "CannotUpdate",
    "ChainWarning",
    "DHLink",
    "DHRow",
    "DHTable",
    "DuplicateEntry",
    "Finding",
    "GravityNotSavedWarning",
    "InertialsFromMeshes",
    "Inspection",
    "InvalidChain",
    "InvalidDH",
    "InvalidLock",
    "InvalidLoop",
    "InvalidMJCF",
    "InvalidMimic",
    "InvalidNumber",
    "InvalidRepair",
    "InvalidRobot",
    "InvalidXacro",
    "Loop",
    "MalformedXML",
    "MimicJointWarning",
    "MissingEntry",
    "MissingInertialWarning",
    "MissingShape",
    "MujocoNotInstalled",
    "NotATree",
    "Patch",
    "Reading",
    "ReadingKeywords",
    "RepairWarning",
    "RepairedFile",
    "RobotEntry",
    "RobotNotFound",
    "Shape",
    "Shapes",
    "TooLarge",
    "URDFError",
    "URDFWarning",
    "UnboundJointWarning",
    "UnreadWarning",
    "UnsupportedConstraint",
    "UnsupportedJoint",
    "Update",
    "WrittenInertial",
    "WrittenJoint",
    "WrittenMimic",
    "WrittenOrigin",
    "WrittenRobot",
    "Xacro",
    "XacroNotInstalled",
    "XacroWarning",
    "ZeroMassWarning",
    "dh_table",
    "fused_links",
    "inspect",
    "load",
    "patch_mjcf",
    "repair",
    "robots",
    "save",
    "save_dh",
    "save_mjcf",
    "shapes",
    "update",
    "written",
]
