"""From recordings and a robot to a model that predicts: preparation, methods side by side, recommendation."""

from crosscheck.identifying.holding_out import ByRows, ByTime, Folds, HeldOut, LastPart, OtherRecordings
from crosscheck.identifying.identify import identify
from crosscheck.identifying.methods import METHODS, STANDARD_METHODS, method_named
from crosscheck.identifying.pinocchio_method import WithPinocchio
from crosscheck.identifying.preparation import Preparation
from crosscheck.identifying.recommending import Recommendation, recommendation
from crosscheck.identifying.result import Identified, TorqueCurve
from crosscheck.identifying.torque_terms import TERMS, friction_terms
from crosscheck.identifying.virtual import VirtualRobot, virtual_robot
from crosscheck.identifying.wrench_method import FromWrenches

__all__ = [
    "METHODS",
    "STANDARD_METHODS",
    "TERMS",
    "ByRows",
    "ByTime",
    "Folds",
    "FromWrenches",
    "HeldOut",
    "Identified",
    "LastPart",
    "OtherRecordings",
    "Preparation",
    "Recommendation",
    "TorqueCurve",
    "VirtualRobot",
    "WithPinocchio",
    "friction_terms",
    "identify",
    "method_named",
    "recommendation",
    "virtual_robot",
]
