"""From recordings and a robot to a model that predicts: preparation, methods side by side, recommendation."""

from crosscheck.identifying.candidate_models import CandidateModel
from crosscheck.identifying.holding_out import ByRows, ByTime, Folds, HeldOut, LastPart, OtherRecordings
from crosscheck.identifying.identified_model import Candidate, IdentifiedModel, TorqueCurve
from crosscheck.identifying.identify import identify
from crosscheck.identifying.long_recordings import identify_long
from crosscheck.identifying.methods import METHODS, STANDARD_METHODS, method_named, method_with
from crosscheck.identifying.pinocchio_method import WithPinocchio
from crosscheck.identifying.preparation import Preparation
from crosscheck.identifying.recommending import Recommendation, recommendation
from crosscheck.identifying.result import Identified
from crosscheck.identifying.torque_terms import TERMS, friction_terms, term_with
from crosscheck.identifying.virtual import VirtualRobot, virtual_robot
from crosscheck.identifying.wrench_method import FromWrenches

__all__ = [
    "METHODS",
    "STANDARD_METHODS",
    "TERMS",
    "ByRows",
    "ByTime",
    "Candidate",
    "CandidateModel",
    "Folds",
    "FromWrenches",
    "HeldOut",
    "Identified",
    "IdentifiedModel",
    "LastPart",
    "OtherRecordings",
    "Preparation",
    "Recommendation",
    "TorqueCurve",
    "VirtualRobot",
    "WithPinocchio",
    "friction_terms",
    "identify",
    "identify_long",
    "method_named",
    "method_with",
    "recommendation",
    "term_with",
    "virtual_robot",
]
