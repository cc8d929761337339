"""Constrained dynamics of robot arms as a graph: bodies are vertices, joints are edges, one system for everything.

The names in `__all__` are the whole public interface, with those in `__all__` of the six modules among them:
identification (parameters from data, with its module terms), excitation (motions for it), aligning (two descriptions of
one robot), export (code to take along), motion_laws (for virtual experiments) and layout (rows and columns of stacked
vectors). All other modules may change without notice. docs/notation.md relates the names to the paper.
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
from graphdyn.experiments.experiment import simulate_recording
from graphdyn.experiments.kr500 import kr500, kr500_experiment
from graphdyn.experiments.virtual_recording import VirtualRecording
from graphdyn.model.chord import Chord
from graphdyn.model.coupling import Coupling
from graphdyn.model.graph import Graph
from graphdyn.model.inertia import Consistency
from graphdyn.model.parts import Body, Frame, Joint, JointLimits
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import Placement
from graphdyn.verbs import answers as _answers
from graphdyn.verbs import assembly as _assembly
from graphdyn.verbs import compiled as _compiled
from graphdyn.verbs import derivatives as _derivatives
from graphdyn.verbs import dynamics as _dynamics
from graphdyn.verbs import energies as _energies
from graphdyn.verbs import frames as _frames
from graphdyn.verbs import matrices as _matrices
from graphdyn.verbs import momenta as _momenta
from graphdyn.verbs import recorded_function as _recorded_function
from graphdyn.verbs.answers import *  # noqa: F403
from graphdyn.verbs.assembly import *  # noqa: F403
from graphdyn.verbs.compiled import *  # noqa: F403
from graphdyn.verbs.derivatives import *  # noqa: F403
from graphdyn.verbs.dynamics import *  # noqa: F403
from graphdyn.verbs.energies import *  # noqa: F403
from graphdyn.verbs.frames import *  # noqa: F403
from graphdyn.verbs.matrices import *  # noqa: F403
from graphdyn.verbs.momenta import *  # noqa: F403
from graphdyn.verbs.recorded_function import *  # noqa: F403

if TYPE_CHECKING:
    from graphdyn import aligning, excitation, export, identification
    from graphdyn import simulation as _simulation
    from graphdyn.simulation import *  # noqa: F403
else:
    _SIMULATION = (
        "Bristles",
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
        """Imports graphdyn.aligning, identification, excitation, export, and what simulates, when first used."""
        if name in ("aligning", "excitation", "export", "identification"):
            return import_module(f"graphdyn.{name}")
        if name in _SIMULATION:
            return getattr(import_module("graphdyn.simulation"), name)
        raise AttributeError(f"module 'graphdyn' has no attribute '{name}'")


__version__ = "0.1.0"

__all__ = [
    "BaseMotion",
    "Body",
    "Chord",
    "Consistency",
    "Coupling",
    "EstimationFailed",
    "Frame",
    "GimbalLock",
    "Graph",
    "GraphDynError",
    "InconsistentState",
    "IntegrationFailed",
    "InvalidInput",
    "InvalidModel",
    "Joint",
    "JointLimits",
    "KKTSolution",
    "KKTSystem",
    "LoopAnalysis",
    "MaximalState",
    "Placement",
    "RankDeficientConstraints",
    "RobotModel",
    "SingularMassMatrix",
    "UnknownFrame",
    "VirtualRecording",
    "aligning",
    "analyze_loops",
    "excitation",
    "export",
    "frame_placement",
    "identification",
    "joint_acceleration",
    "joint_state",
    "kr500",
    "kr500_experiment",
    "layout",
    "maximal_state",
    "motion_laws",
    "simulate_recording",
]
__all__ += _answers.__all__
__all__ += _assembly.__all__
__all__ += _compiled.__all__
__all__ += _derivatives.__all__
__all__ += _dynamics.__all__
__all__ += _energies.__all__
__all__ += _frames.__all__
__all__ += _matrices.__all__
__all__ += _momenta.__all__
__all__ += _recorded_function.__all__
if TYPE_CHECKING:
    __all__ += _simulation.__all__
else:
    __all__ += _SIMULATION
__all__.sort()
