"""Simulation of the loop of a recording: motions without noise, for instruments and output errors."""

from graphdyn.identification.closed_loop.exogeneity_test import EXOGENEITY_SETTING, Exogeneity, exogeneity
from graphdyn.identification.closed_loop.loop import MAX_SIMULATION_STEP, ClosedLoop, DrivenRobot, held_torque
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop

__all__ = [
    "EXOGENEITY_SETTING",
    "MAX_SIMULATION_STEP",
    "ClosedLoop",
    "DrivenRobot",
    "Exogeneity",
    "SimulatedLoop",
    "exogeneity",
    "held_torque",
]
