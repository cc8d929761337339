"""Constrained dynamics of robot arms as a graph: bodies are vertices, joints are edges, one system for everything.

The names in `__all__` are the whole public interface, with those in `__all__` of the four modules among them:
identification (parameters from data, with its module terms), excitation (motions for it), motion_laws (for virtual
experiments) and layout (rows and columns of stacked vectors). All other modules may change without notice.
docs/notation.md relates the names to the paper.
"""

from importlib import import_module
from typing import TYPE_CHECKING

from graphdyn import layout, motion_laws
from graphdyn._answers import (
    EnergyRegressor,
    ForwardDynamics,
    ForwardDynamicsDerivatives,
    InverseDynamics,
    InverseDynamicsDerivatives,
    InverseDynamicsSecondDerivatives,
    Momentum,
    ReactionDerivatives,
)
from graphdyn._assemble import assemble
from graphdyn._base_motion import BaseMotion
from graphdyn._chord import Chord
from graphdyn._compiled import CompiledModel, compile
from graphdyn._coupling import Coupling
from graphdyn._derivatives import (
    forward_dynamics_derivatives,
    forward_dynamics_parameter_derivatives,
    inverse_dynamics_derivatives,
    inverse_dynamics_second_derivatives,
    reaction_derivatives,
)
from graphdyn._dynamics import (
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
from graphdyn._energies import energy_regressor, kinetic_energy, potential_energy, power
from graphdyn._errors import (
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
from graphdyn._experiment import record
from graphdyn._frames import frame_acceleration, frame_jacobian, frame_jacobian_derivative, frame_velocity
from graphdyn._graph import Graph
from graphdyn._inertia import Consistency
from graphdyn._joint_readings import joint_acceleration, joint_state
from graphdyn._kinematics import MaximalState, frame_placement, maximal_state
from graphdyn._kkt import KKTSolution, KKTSystem
from graphdyn._kr500 import kr500, kr500_experiment
from graphdyn._loop_analysis import LoopAnalysis, analyze_loops
from graphdyn._matrices import (
    body_regressor,
    coriolis_matrix,
    joint_torque_regressor,
    mass_matrix,
    mass_matrix_inverse,
    momentum_regressor,
)
from graphdyn._model import RobotModel
from graphdyn._momentum import (
    center_of_mass,
    center_of_mass_jacobian,
    center_of_mass_velocity,
    centroidal_map,
    momentum,
)
from graphdyn._parts import Body, Frame, Joint, JointLimits
from graphdyn._placement import Placement
from graphdyn._recorded_function import RecordedFunction
from graphdyn._virtual_recording import VirtualRecording

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
