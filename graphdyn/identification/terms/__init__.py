"""Terms of the actuator torque: one class per physical effect, each linear in its parameters."""

from graphdyn.identification.terms.bodies import KnownBodies, KnownPayload, Payload, PayloadMass, RigidBodies
from graphdyn.identification.terms.drift import Drift
from graphdyn.identification.terms.drives import CoupledWrist, RotorInertia
from graphdyn.identification.terms.friction import (
    DEFLECTION,
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    LoadFriction,
    MaxwellSlip,
    Offset,
    SmoothCoulomb,
    Spring,
    Stribeck,
    Viscous,
)
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
