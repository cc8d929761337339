"""Robots in motion: what graphdyn.simulate and graphdyn.rollout take and answer.

Public are the names in `__all__` here, which graphdyn exports too. Other modules may change without notice.
"""

from graphdyn.simulation.integration.events import Event, Occurrence
from graphdyn.simulation.many_robots import MeasurementNoise, Rollout, rollout
from graphdyn.simulation.one_robot import simulate
from graphdyn.simulation.plant import Bristles, Friction, JointStops
from graphdyn.simulation.result import EnergyBalance, Simulation
from graphdyn.simulation.torques import ComputedTorqueControl, PDControl

__all__ = [
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
]
