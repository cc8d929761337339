"""Limits beyond which a number comes from a corrupted line, not from a joint.

Generous on purpose, by a factor of ten or more: they separate 1e157 from a measurement, not good robots from bad.
"""

from __future__ import annotations

from typing import NamedTuple


class Limit(NamedTuple):
    value: float
    why: str


TIME = Limit(1e10, "300 years after 1970")

TURNING = {
    "q": Limit(1e4, "1600 turns in one direction"),
    "v": Limit(1e3, "ten times the fastest direct drive, 9500 turns a minute behind the gears"),
    "a": Limit(1e6, "standstill to 1000 rad/s in a millisecond"),
    "tau": Limit(1e6, "ten times what the main axes of the largest industrial arms hold"),
    "temperature": Limit(1e3, "copper melts"),
}
SLIDING = {
    "q": Limit(1e3, "a kilometre of rail"),
    "v": Limit(1e2, "ten times the fastest linear axis"),
    "a": Limit(1e5, "ten thousand times gravity"),
    "tau": Limit(1e7, "the weight of a thousand tonnes"),
    "temperature": TURNING["temperature"],
}

MANY_TURNS = 40.0
"""Position beyond which an angle may be in degrees [rad]: few joints turn more than six times."""
