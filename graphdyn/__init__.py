"""Constrained dynamics of robot arms as a graph: bodies are vertices, joints are edges, one system for everything.

The names in `__all__` are the whole public interface, with those in `__all__` of the four modules among them:
identification (parameters from data, with its module terms), excitation (motions for it), motion_laws (for virtual
experiments) and layout (rows and columns of stacked vectors). All other modules may change without notice.
docs/notation.md relates the names to the paper.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from graphdyn import layout, motion_laws
from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.equations.joint_readings import joint_acceleration, joint_state
from graphdyn.equations.kinematics import MaximalState, frame_placement, maximal_state
from graphdyn.equations.loops.analysis import LoopAnalysis, analyze_loops
from graphdyn.equations.system.kkt import KKTSolution, KKTSystem
from graphdyn.errors import (
    EstimationFailed,
    GimbalLock,
    GraphDynError,
    InconsistentState,
    IntegrationFailed,
    InvalidInput,
    InvalidModel,
    RankDeficientConstraints,
    SingularMassMatrix,
    UnknownFrame,
)
from graphdyn.experiments.experiment import record
from graphdyn.experiments.kr500 import kr500, kr500_experiment
from graphdyn.experiments.virtual_recording import VirtualRecording
from graphdyn.model.chord import Chord
from graphdyn.model.coupling import Coupling
from graphdyn.model.graph import Graph
from graphdyn.model.inertia import Consistency
from graphdyn.model.parts import Body, Frame, Joint, JointLimits
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import Placement
from graphdyn.verbs.answers import (
    EnergyRegressor,
    ForwardDynamics,
    ForwardDynamicsDerivatives,
    InverseDynamics,
    InverseDynamicsDerivatives,
    InverseDynamicsSecondDerivatives,
    Momentum,
    ReactionDerivatives,
)
from graphdyn.verbs.assembly import assemble
from graphdyn.verbs.compiled import CompiledModel, compile
from graphdyn.verbs.derivatives import (
    forward_dynamics_derivatives,
    forward_dynamics_parameter_derivatives,
    inverse_dynamics_derivatives,
    inverse_dynamics_second_derivatives,
    reaction_derivatives,
)
from graphdyn.verbs.dynamics import (
    bias_torque,
    forward_dynamics,
    gravity_torque,
    inverse_dynamics,
    joint_accelerations,
    joint_torques,
    kkt_system,
    solve_kkt,
    static_torque,
)
from graphdyn.verbs.energies import energy_regressor, kinetic_energy, potential_energy, power
from graphdyn.verbs.frames import frame_acceleration, frame_jacobian, frame_jacobian_derivative, frame_velocity
from graphdyn.verbs.matrices import (
    body_regressor,
    coriolis_matrix,
    joint_torque_regressor,
    mass_matrix,
    mass_matrix_inverse,
    momentum_regressor,
)
from graphdyn.verbs.momentum import (
    center_of_mass,
    center_of_mass_jacobian,
    center_of_mass_velocity,
    centroidal_map,
    momentum,
)
from graphdyn.verbs.recorded_function import RecordedFunction

if TYPE_CHECKING:
    from graphdyn import excitation, identification
    from graphdyn.simulation import (
        ComputedTorqueControl,
        EnergyBalance,
        Event,
        Friction,
        JointStops,
        MeasurementNoise,
        Occurrence,
        PDControl,
        Rollout,
        Simulation,
        rollout,
        simulate,
    )
else:
    _SIMULATION = (
        "ComputedTorqueControl",
        "EnergyBalance",
        "Event",
        "Friction",
        "JointStops",
        "MeasurementNoise",
        "Occurrence",
        "PDControl",
        "Rollout",
        "Simulation",
        "rollout",
        "simulate",
    )

    def __getattr__(name: str) -> object:
        """Imports graphdyn.identification, graphdyn.excitation, and what simulates, when first used."""
        if name in ("excitation", "identification"):
            return import_module(f"graphdyn.{name}")
        if name in _SIMULATION:
            return getattr(import_module("graphdyn.simulation"), name)
        raise AttributeError(f"module 'graphdyn' has no attribute '{name}'")


__version__ = "0.1.0"

__all__ = [
    "BaseMotion",
    "Body",
    "Chord",
    "CompiledModel",
    "ComputedTorqueControl",
    "Consistency",
    "Coupling",
    "EnergyBalance",
    "EnergyRegressor",
    "EstimationFailed",
    "Event",
    "ForwardDynamics",
    "ForwardDynamicsDerivatives",
    "Frame",
    "Friction",
    "GimbalLock",
    "Graph",
    "GraphDynError",
    "InconsistentState",
    "IntegrationFailed",
    "InvalidInput",
    "InvalidModel",
    "InverseDynamics",
    "InverseDynamicsDerivatives",
    "InverseDynamicsSecondDerivatives",
    "Joint",
    "JointLimits",
    "JointStops",
    "KKTSolution",
    "KKTSystem",
    "LoopAnalysis",
    "MaximalState",
    "MeasurementNoise",
    "Momentum",
    "Occurrence",
    "PDControl",
    "Placement",
    "RankDeficientConstraints",
    "ReactionDerivatives",
    "RecordedFunction",
    "RobotModel",
    "Rollout",
    "Simulation",
    "SingularMassMatrix",
    "UnknownFrame",
    "VirtualRecording",
    "analyze_loops",
    "assemble",
    "bias_torque",
    "body_regressor",
    "center_of_mass",
    "center_of_mass_jacobian",
    "center_of_mass_velocity",
    "centroidal_map",
    "compile",
    "coriolis_matrix",
    "energy_regressor",
    "excitation",
    "forward_dynamics",
    "forward_dynamics_derivatives",
    "forward_dynamics_parameter_derivatives",
    "frame_acceleration",
    "frame_jacobian",
    "frame_jacobian_derivative",
    "frame_placement",
    "frame_velocity",
    "gravity_torque",
    "identification",
    "inverse_dynamics",
    "inverse_dynamics_derivatives",
    "inverse_dynamics_second_derivatives",
    "joint_acceleration",
    "joint_accelerations",
    "joint_state",
    "joint_torque_regressor",
    "joint_torques",
    "kinetic_energy",
    "kkt_system",
    "kr500",
    "kr500_experiment",
    "layout",
    "mass_matrix",
    "mass_matrix_inverse",
    "maximal_state",
    "momentum",
    "momentum_regressor",
    "motion_laws",
    "potential_energy",
    "power",
    "reaction_derivatives",
    "record",
    "rollout",
    "simulate",
    "solve_kkt",
    "static_torque",
]
