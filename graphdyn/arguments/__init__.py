"""What all verbs take: arrays of one leading shape, the motion of the base, the choice of a method and of a frame."""

from graphdyn.arguments.arrays import one_state
from graphdyn.arguments.choices import MANY_SAMPLES, Method, Reference, frame_choice, reproducible
from graphdyn.arguments.keywords import closest, refuse_unknown

__all__ = [
    "MANY_SAMPLES",
    "Method",
    "Reference",
    "closest",
    "frame_choice",
    "one_state",
    "refuse_unknown",
    "reproducible",
]
