"""Inertial parameters from data."""

from graphdyn.identification.base_parameters import BaseParameters, base_parameters
from graphdyn.identification.body_wrenches import WrenchData, body_wrenches, link_wrenches
from graphdyn.identification.identified_bodies import IdentifiedBodies
from graphdyn.identification.inertial_parameters import (
    IdentifiedInertia,
    identified_inertia,
    identify_inertial_parameters,
    identify_inertial_parameters_together,
    joint_wrench_regressor,
)
from graphdyn.identification.least_squares import LeastSquares, ordinary_least_squares
from graphdyn.identification.principal_parameters import (
    PRINCIPAL_PARAMETER_NAMES,
    identify_principal_parameters,
    identify_principal_parameters_together,
    mass_rows,
    moment_rows,
    principal_regressor,
)
from graphdyn.identification.rank_revealing import ParameterEstimate

__all__ = [
    "PRINCIPAL_PARAMETER_NAMES",
    "BaseParameters",
    "IdentifiedBodies",
    "IdentifiedInertia",
    "LeastSquares",
    "ParameterEstimate",
    "WrenchData",
    "base_parameters",
    "body_wrenches",
    "identified_inertia",
    "identify_inertial_parameters",
    "identify_inertial_parameters_together",
    "identify_principal_parameters",
    "identify_principal_parameters_together",
    "joint_wrench_regressor",
    "link_wrenches",
    "mass_rows",
    "moment_rows",
    "ordinary_least_squares",
    "principal_regressor",
]
