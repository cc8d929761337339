"""Virtual experiments: prescribed motions, what instruments would record of them, and the paper's robot."""

from graphdyn.experiments.kr500 import GRAVITY, LENGTHS, RADII, RAIL_ACCELERATION
from graphdyn.experiments.virtual_recording import CHANNELS

__all__ = [
    "CHANNELS",
    "GRAVITY",
    "LENGTHS",
    "RADII",
    "RAIL_ACCELERATION",
]
