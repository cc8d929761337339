"""Identification of a robot from recordings: preparation, comparison of methods, recommendation."""

from crosscheck.identifying.identify import identify
from crosscheck.identifying.long_recordings import METHODS_OF_SUMS, STANDARD_METHODS_OF_SUMS
from crosscheck.identifying.methods.candidate_models import CandidateModel
from crosscheck.identifying.methods.methods import (
    ESTIMATORS,
    STANDARD_METHODS,
    WithPinocchio,
    method_named,
    method_with,
    without_wrenches,
)
from crosscheck.identifying.methods.torque_terms import TERMS, friction_terms, term_with
from crosscheck.identifying.methods.wrench_method import FromWrenches
from crosscheck.identifying.payload.fitted_currents import STATED_ERROR, FittedCurrents
from crosscheck.identifying.payload.gains import as_torques, identify_gains
from crosscheck.identifying.payload.gains_file import gains_document, load_gains
from crosscheck.identifying.payload.payload import IdentifiedPayload, identify_payload
from crosscheck.identifying.preparing.holding_out import ByRows, ByTime, Folds, HeldOut, LastPart, OtherRecordings
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.identifying.rehearsal import REHEARSED_METHODS, Conditions, Outcome, Rehearsal, rehearse
from crosscheck.identifying.results.identified_model import Candidate, IdentifiedModel, TorqueCurve
from crosscheck.identifying.results.recommending import Recommendation, recommendation
from crosscheck.identifying.results.result import Identified
from crosscheck.identifying.virtual import VirtualRobot, virtual_robot

__all__ = [
    "ESTIMATORS",
    "METHODS_OF_SUMS",
    "REHEARSED_METHODS",
    "STANDARD_METHODS",
    "STANDARD_METHODS_OF_SUMS",
    "STATED_ERROR",
    "TERMS",
    "ByRows",
    "ByTime",
    "Candidate",
    "CandidateModel",
    "Conditions",
    "FittedCurrents",
    "Folds",
    "FromWrenches",
    "HeldOut",
    "Identified",
    "IdentifiedModel",
    "IdentifiedPayload",
    "LastPart",
    "OtherRecordings",
    "Outcome",
    "Preparation",
    "Recommendation",
    "Rehearsal",
    "TorqueCurve",
    "VirtualRobot",
    "WithPinocchio",
    "as_torques",
    "friction_terms",
    "gains_document",
    "identify",
    "identify_gains",
    "identify_payload",
    "load_gains",
    "method_named",
    "method_with",
    "recommendation",
    "rehearse",
    "term_with",
    "virtual_robot",
    "without_wrenches",
]
