"""Terms of the actuator torque: one class per physical effect, each linear in its parameters."""

from graphdyn.identification.terms.drift import Drift
from graphdyn.identification.terms.drives import CoupledWrist, RotorInertia
from graphdyn.identification.terms.friction import (
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    Offset,
    Spring,
    Stribeck,
    Viscous,
)
from graphdyn.identification.terms.load_friction import LoadFriction, SmoothCoulomb
from graphdyn.identification.terms.maxwell_slip import DEFLECTION, MaxwellSlip
from graphdyn.identification.terms.payload import KnownPayload, Payload, PayloadMass
from graphdyn.identification.terms.rigid_bodies import KnownBodies, RigidBodies
from graphdyn.identification.terms.term import CarriesBodies, CarriesKnownBodies, KnownTerm, Term, TermParameter
from graphdyn.identification.terms.user_columns import KnownTorque, ScaledTorque, UserColumns

__all__ = [
    "DEFLECTION",
    "AsymmetricCoulomb",
    "AsymmetricViscous",
    "CarriesBodies",
    "CarriesKnownBodies",
    "Coulomb",
    "CoupledWrist",
    "Drift",
    "KnownBodies",
    "KnownPayload",
    "KnownTerm",
    "KnownTorque",
    "LoadFriction",
    "MaxwellSlip",
    "Offset",
    "Payload",
    "PayloadMass",
    "RigidBodies",
    "RotorInertia",
    "ScaledTorque",
    "SmoothCoulomb",
    "Spring",
    "Stribeck",
    "Term",
    "TermParameter",
    "UserColumns",
    "Viscous",
]
