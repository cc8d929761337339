"""The reference implementation: the same robot in Pinocchio. The only package that imports it.

There are two routes: Pinocchio reads the URDF file itself (which checks our import), or its model is built from our
RobotModel through its API (which checks our dynamics). Results are returned in the order and the axes of graphdyn.
"""

from crosscheck.reference.pinocchio_model.answers import PinocchioAnswers
from crosscheck.reference.pinocchio_model.model import PinocchioModel
from crosscheck.reference.pinocchio_model.native import PINOCCHIO_VERSION, UNIVERSE, PinocchioRefuses, function_named

__all__ = [
    "PINOCCHIO_VERSION",
    "UNIVERSE",
    "PinocchioAnswers",
    "PinocchioModel",
    "PinocchioRefuses",
    "function_named",
]
