"""The description of a robot: bodies, joints, couplings, chords. It never changes."""

from graphdyn.model.assembly import assembled, refuse_infinitesimal
from graphdyn.model.chord import FORCES, MOMENTS, ChordKind
from graphdyn.model.coupling import DegreesOfFreedom
from graphdyn.model.inertia import (
    PARAMETER_NAMES,
    TRIANGLE_TOLERANCE_SHARE,
    consistency_problems,
    parallel_axis,
    parameters_from_inertia,
    pseudo_inertia_from_parameters,
)
from graphdyn.model.loops import CLOSED_TOLERANCE, LOOP_RANK_TOLERANCE, loop_spaces
from graphdyn.model.parts import unit_of
from graphdyn.model.robot_model import STANDARD_GRAVITY, check_model
from graphdyn.model.spatial import apply, cos_beta, cross, rotation_about, rotation_vector, skew, solve

__all__ = [
    "CLOSED_TOLERANCE",
    "FORCES",
    "LOOP_RANK_TOLERANCE",
    "MOMENTS",
    "PARAMETER_NAMES",
    "STANDARD_GRAVITY",
    "TRIANGLE_TOLERANCE_SHARE",
    "ChordKind",
    "DegreesOfFreedom",
    "apply",
    "assembled",
    "check_model",
    "consistency_problems",
    "cos_beta",
    "cross",
    "loop_spaces",
    "parallel_axis",
    "parameters_from_inertia",
    "pseudo_inertia_from_parameters",
    "refuse_infinitesimal",
    "rotation_about",
    "rotation_vector",
    "skew",
    "solve",
    "unit_of",
]
