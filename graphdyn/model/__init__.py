"""The description of a robot: bodies, joints, couplings, chords. It never changes."""

from graphdyn.model.assembly import assembled
from graphdyn.model.chord import FORCES, MOMENTS, ChordKind
from graphdyn.model.inertia import (
    CONSISTENCY,
    PARAMETER_NAMES,
    consistency_problems,
    parallel_axis,
    parameters_from_inertia,
    pseudo_inertia_from_parameters,
)
from graphdyn.model.loops import CLOSED, RANK, loop_spaces
from graphdyn.model.robot_model import STANDARD_GRAVITY, check_model
from graphdyn.model.spatial import apply, cos_beta, cross, rotation_about, skew, solve

__all__ = [
    "CLOSED",
    "CONSISTENCY",
    "FORCES",
    "MOMENTS",
    "PARAMETER_NAMES",
    "RANK",
    "STANDARD_GRAVITY",
    "ChordKind",
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
    "rotation_about",
    "skew",
    "solve",
]
