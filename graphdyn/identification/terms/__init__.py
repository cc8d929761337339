"""What actuator torques are made of: one class per physical effect, each linear in its parameters."""

from graphdyn.identification.terms.drives import CoupledWrist, RotorInertia
from graphdyn.identification.terms.friction import (
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    Offset,
    Stribeck,
    Viscous,
)
from graphdyn.identification.terms.load_friction import LoadFriction, SmoothCoulomb
from graphdyn.identification.terms.payload import KnownPayload, Payload, PayloadMass
from graphdyn.identification.terms.rigid_bodies import KnownBodies, RigidBodies
from graphdyn.identification.terms.term import Column, KnownTerm, Term
from graphdyn.identification.terms.user_columns import KnownTorque, ScaledTorque, UserColumns

__all__ = [
    "AsymmetricCoulomb",
    "AsymmetricViscous",
    "Column",
    "Coulomb",
    "CoupledWrist",
    "KnownBodies",
    "KnownPayload",
    "KnownTerm",
    "KnownTorque",
    "LoadFriction",
    "Offset",
    "Payload",
    "PayloadMass",
    "RigidBodies",
    "RotorInertia",
    "ScaledTorque",
    "SmoothCoulomb",
    "Stribeck",
    "Term",
    "UserColumns",
    "Viscous",
]
