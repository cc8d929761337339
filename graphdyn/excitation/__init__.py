"""Exciting motions: motions of a robot with most information on its parameters, and the accuracy they will give.

The public names are those in `__all__`.
"""

from graphdyn.excitation.bases import Basis, FourierBasis, SplineBasis
from graphdyn.excitation.constraints import smallest_distances
from graphdyn.excitation.information import ConditionNumber, Criterion, log_det, mean_sigma
from graphdyn.excitation.limits import LIMIT_KINDS, Clearance, MotionLimits, Plane, Poses, Sphere, frame_origins
from graphdyn.excitation.optimizing import CHECK_RATE, ExcitationProblem, NoFeasibleMotion, OptimizedMotion, optimized
from graphdyn.excitation.plan import ExcitationPlan, excitation_plan, expected_parameters, prior_spread
from graphdyn.excitation.random_motions import random_trajectory
from graphdyn.excitation.trajectory import FiniteMotion, JointMotion, TabulatedCourse, Trajectory, Usage, sample_times

__all__ = [
    "CHECK_RATE",
    "LIMIT_KINDS",
    "Basis",
    "Clearance",
    "ConditionNumber",
    "Criterion",
    "ExcitationPlan",
    "ExcitationProblem",
    "FiniteMotion",
    "FourierBasis",
    "JointMotion",
    "MotionLimits",
    "NoFeasibleMotion",
    "OptimizedMotion",
    "Plane",
    "Poses",
    "Sphere",
    "SplineBasis",
    "TabulatedCourse",
    "Trajectory",
    "Usage",
    "excitation_plan",
    "expected_parameters",
    "frame_origins",
    "log_det",
    "mean_sigma",
    "optimized",
    "prior_spread",
    "random_trajectory",
    "sample_times",
    "smallest_distances",
]
