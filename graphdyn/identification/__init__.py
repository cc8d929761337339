"""Identification of inertial parameters from recordings.

The public names are those in `__all__` here and in graphdyn.identification.terms, the parts of a torque model. Other
modules may change without notice.
"""

from graphdyn.identification import estimators
from graphdyn.identification.algebra.accumulator import Accumulator
from graphdyn.identification.algebra.base_parameters import BaseParameters, base_parameters
from graphdyn.identification.algebra.compressed import EPS, CompressedEquations, joint_noise, weighted_solution
from graphdyn.identification.algebra.least_squares import LeastSquares, one_thread, ordinary_least_squares
from graphdyn.identification.algebra.rank_revealing import ParameterEstimate
from graphdyn.identification.bodies import BodyLimits, PhysicalLimits, ReachedLimit
from graphdyn.identification.closed_loop import ClosedLoop
from graphdyn.identification.data.samples import Partitioned, RowFilter, Samples
from graphdyn.identification.estimation.comparison import (
    CHECKED_POSES,
    MIN_CORRELATION_TIMES,
    MethodComparison,
    MethodResult,
    Plausibility,
    compare_methods,
    plausibility,
)
from graphdyn.identification.estimation.estimate import Estimate, Estimator
from graphdyn.identification.estimation.tuning import Tunable, Tuned, tuned
from graphdyn.identification.estimators import *  # noqa: F403
from graphdyn.identification.online.extended_kalman import ExtendedKalmanFilter
from graphdyn.identification.online.recursive import RecursiveLeastSquares
from graphdyn.identification.problem.prior import Prior, model_prior
from graphdyn.identification.problem.problem import Problem, own_rows
from graphdyn.identification.problem.torque_model import TorqueModel, structure
from graphdyn.identification.statistics.residual_statistics import (
    MIN_MOVING_SPEED,
    ResidualSizes,
    ResidualStatistics,
    residual_statistics,
)
from graphdyn.identification.wrenches.body_wrenches import WrenchData, body_wrenches, link_wrenches
from graphdyn.identification.wrenches.inertial_parameters import (
    IdentifiedInertia,
    identified_inertia,
    identify_inertial_parameters,
    identify_inertial_parameters_together,
    joint_wrench_regressor,
)
from graphdyn.identification.wrenches.principal_parameters import (
    PRINCIPAL_PARAMETER_NAMES,
    identify_principal_parameters,
    identify_principal_parameters_together,
    mass_rows,
    moment_rows,
    principal_regressor,
)
from graphdyn.identification.wrenches.wrench_equations import IdentifiedBodies

__all__ = [
    "CHECKED_POSES",
    "EPS",
    "MIN_CORRELATION_TIMES",
    "MIN_MOVING_SPEED",
    "PRINCIPAL_PARAMETER_NAMES",
    "Accumulator",
    "BaseParameters",
    "BodyLimits",
    "ClosedLoop",
    "CompressedEquations",
    "Estimate",
    "Estimator",
    "ExtendedKalmanFilter",
    "IdentifiedBodies",
    "IdentifiedInertia",
    "LeastSquares",
    "MethodComparison",
    "MethodResult",
    "ParameterEstimate",
    "Partitioned",
    "PhysicalLimits",
    "Plausibility",
    "Prior",
    "Problem",
    "ReachedLimit",
    "RecursiveLeastSquares",
    "ResidualSizes",
    "ResidualStatistics",
    "RowFilter",
    "Samples",
    "TorqueModel",
    "Tunable",
    "Tuned",
    "WrenchData",
    "base_parameters",
    "body_wrenches",
    "compare_methods",
    "identified_inertia",
    "identify_inertial_parameters",
    "identify_inertial_parameters_together",
    "identify_principal_parameters",
    "identify_principal_parameters_together",
    "joint_noise",
    "joint_wrench_regressor",
    "link_wrenches",
    "mass_rows",
    "model_prior",
    "moment_rows",
    "one_thread",
    "ordinary_least_squares",
    "own_rows",
    "plausibility",
    "principal_regressor",
    "residual_statistics",
    "structure",
    "tuned",
    "weighted_solution",
]
__all__ += estimators.__all__
