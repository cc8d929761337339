"""Gains of motor currents, and loads, from recordings with and without a load.

A joint's current is its torque over its gain, with the errors on the side of the currents:

    c_j = (W_j π + W_Lj π_L) / K_j + F_j ψ_j + ε_j

with the links π, a load π_L on one of them, and friction ψ_j in units of the current. Regressing torques on currents
instead takes the currents for exact, and gains come out too small.

The currents alone determine no gain: all gains and all parameters of links and loads scale together. One of these must
be known: a load, the gains, or the gravity of the links.
"""

from graphdyn.identification.currents.equations import CurrentEquations, LoadedRecording
from graphdyn.identification.currents.fit import CurrentFit, fit_currents
from graphdyn.identification.currents.gains import JointGains
from graphdyn.identification.currents.loads import IdentifiedLoad, KnownLoad
from graphdyn.identification.currents.sensitivity import gain_deviations
from graphdyn.identification.currents.trusted_gravity import TrustedGravity

__all__ = [
    "CurrentEquations",
    "CurrentFit",
    "IdentifiedLoad",
    "JointGains",
    "KnownLoad",
    "LoadedRecording",
    "TrustedGravity",
    "fit_currents",
    "gain_deviations",
]
