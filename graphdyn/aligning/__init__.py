"""Two descriptions of one robot: how the joints, zeros and frames of the second relate to the first, and what differs.

align finds the map, differences compares what is left after it. Both take serial robots.
"""

from graphdyn.aligning.alignment import COUNTED_FROM, Alignment, align
from graphdyn.aligning.causes import Cause
from graphdyn.aligning.fields import FrameDifference, JointDifference, LinkDifference, SettingDifference
from graphdyn.aligning.joint_map import JointMap
from graphdyn.aligning.model_differences import (
    VERDICTS,
    DifferenceVerdict,
    FlangeDifference,
    ModelDifferences,
    differences,
)
from graphdyn.aligning.names import same_names
from graphdyn.aligning.torques import BaseParameterDifference, TorqueDifference

__all__ = [
    "COUNTED_FROM",
    "VERDICTS",
    "Alignment",
    "BaseParameterDifference",
    "Cause",
    "DifferenceVerdict",
    "FlangeDifference",
    "FrameDifference",
    "JointDifference",
    "JointMap",
    "LinkDifference",
    "ModelDifferences",
    "SettingDifference",
    "TorqueDifference",
    "align",
    "differences",
    "same_names",
]
