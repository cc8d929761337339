"""Constrained dynamics of robot arms as a graph: bodies are vertices, joints are edges, one system for everything.

The names below are the public interface; docs/notation.md relates them to the paper.
"""

from graphdyn.answers import ForwardDynamics, InverseDynamics
from graphdyn.base_motion import BaseMotion
from graphdyn.compiled import CompiledModel, compile
from graphdyn.dynamics import (
    bias_torque,
    forward_dynamics,
    inverse_dynamics,
    joint_accelerations,
    joint_torques,
    kkt_system,
    mass_matrix,
    solve_kkt,
)
from graphdyn.errors import (
    GimbalLock,
    GraphDynError,
    InconsistentState,
    InvalidInput,
    InvalidModel,
    RankDeficientConstraints,
    SingularMassMatrix,
    UnknownFrame,
)
from graphdyn.experiment import record
from graphdyn.graph import Graph
from graphdyn.inertia import Consistency
from graphdyn.kinematics import MaximalState, frame_placement, joint_acceleration, joint_state, maximal_state
from graphdyn.kkt import KKTSolution, KKTSystem
from graphdyn.kr500 import kr500, kr500_experiment
from graphdyn.model import Body, Frame, Joint, JointLimits, RobotModel
from graphdyn.placement import Placement
from graphdyn.recording import Recording
from graphdyn.regressors import body_regressor, joint_torque_regressor

__version__ = "0.1.0"

__all__ = [
    "BaseMotion",
    "Body",
    "CompiledModel",
    "Consistency",
    "ForwardDynamics",
    "Frame",
    "GimbalLock",
    "Graph",
    "GraphDynError",
    "InconsistentState",
    "InvalidInput",
    "InvalidModel",
    "InverseDynamics",
    "Joint",
    "JointLimits",
    "KKTSolution",
    "KKTSystem",
    "MaximalState",
    "Placement",
    "RankDeficientConstraints",
    "Recording",
    "RobotModel",
    "SingularMassMatrix",
    "UnknownFrame",
    "bias_torque",
    "body_regressor",
    "compile",
    "forward_dynamics",
    "frame_placement",
    "inverse_dynamics",
    "joint_acceleration",
    "joint_accelerations",
    "joint_state",
    "joint_torque_regressor",
    "joint_torques",
    "kkt_system",
    "kr500",
    "kr500_experiment",
    "mass_matrix",
    "maximal_state",
    "record",
    "solve_kkt",
]
