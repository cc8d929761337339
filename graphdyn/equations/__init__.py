"""The specification: the dynamics as the paper's equations read, one state or many, without a fast path."""

from graphdyn.equations.complex_steps import COMPLEX_STEP_SIZE
from graphdyn.equations.joint_readings import project_accelerations
from graphdyn.equations.kinematics import bias_acceleration, joint_axes, link_origins, null_space
from graphdyn.equations.loops.dynamics import closed
from graphdyn.equations.projected import singular
from graphdyn.equations.system.constraints import constraints
from graphdyn.equations.system.kkt import cardano_drift, cardano_form, rate_map
from graphdyn.equations.system.unconstrained import applied_terms, mass_terms

__all__ = [
    "COMPLEX_STEP_SIZE",
    "applied_terms",
    "bias_acceleration",
    "cardano_drift",
    "cardano_form",
    "closed",
    "constraints",
    "joint_axes",
    "link_origins",
    "mass_terms",
    "null_space",
    "project_accelerations",
    "rate_map",
    "singular",
]
