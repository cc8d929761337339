"""Simulation of the loop in which a recording was made: motions without noise, for instruments and output errors."""

from graphdyn.identification.closed_loop.loop import ClosedLoop, held_torque
from graphdyn.identification.closed_loop.simulated_loop import SimulatedLoop

__all__ = ["ClosedLoop", "SimulatedLoop", "held_torque"]
