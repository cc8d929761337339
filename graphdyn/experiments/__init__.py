"""Virtual experiments: prescribed motions, what instruments would record of them, and the paper's robot."""

from graphdyn.experiments.kr500 import BODY_LENGTHS, BODY_RADII, GRAVITY, RAIL_ACCELERATION
from graphdyn.experiments.virtual_recording import CHANNELS

__all__ = [
    "BODY_LENGTHS",
    "BODY_RADII",
    "CHANNELS",
    "GRAVITY",
    "RAIL_ACCELERATION",
]
