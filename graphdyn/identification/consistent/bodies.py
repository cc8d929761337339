"""The ten columns of every unknown body in a torque model, and the other columns that cannot be negative."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.errors import EstimationFailed
from graphdyn.identification.consistent.manifold import inertial_prior
from graphdyn.identification.problem.prior import Prior, model_prior
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.identification.terms import (
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    LoadFriction,
    MaxwellSlip,
    Payload,
    PayloadMass,
    RigidBodies,
    RotorInertia,
    Viscous,
)
from graphdyn.layout import BODY_PARAMETERS, Array

NONNEGATIVE_TERMS = (
    *(Viscous, Coulomb, AsymmetricViscous, AsymmetricCoulomb, LoadFriction, MaxwellSlip),
    *(RotorInertia, PayloadMass),
)
"""Terms whose parameters cannot be negative: friction dissipates energy, a rotor has mass. Stribeck friction may fall
below zero, because it adds to Coulomb friction."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """The unknown bodies of a torque model.

    names (n,), columns (n,): their ten parameters
    prior: pseudo-inertia matrices, positive definite       (n, 4, 4)
    further: names of the columns that belong to no body, in their order      (k,)
    nonnegative: those of them that cannot be negative
    remarks: changes of the prior, in sentences
    """

    names: tuple[str, ...]
    columns: tuple[slice, ...]
    prior: Array
    further: tuple[str, ...]
    nonnegative: tuple[str, ...]
    remarks: tuple[str, ...]


def unknown_bodies(torque_model: TorqueModel, prior: Prior | None) -> Bodies:
    """Unknown bodies of a torque model, with their prior.

    prior: its mean is read; the parameters of the model if left out. A payload that it does not contain (zero) is
    expected to be like the body that carries it.

    Raises EstimationFailed if no body is unknown, InvalidInput if no body of the prior has a mass.
    """
    model, start = torque_model.model, 0
    names: list[str] = []
    columns: list[slice] = []
    nonnegative: list[str] = []
    in_bodies: set[int] = set()
    carriers: dict[int, int] = {}
    for term in torque_model.terms:
        own = range(start, start := start + len(term.columns(model)))
        if isinstance(term, Payload):
            carriers[len(names)] = model.body_names.index(term.body) if term.body else model.n_bodies - 1
            names.append("payload")
        elif isinstance(term, RigidBodies):
            names.extend(model.body_names)
        else:
            if isinstance(term, NONNEGATIVE_TERMS):
                nonnegative.extend(torque_model.columns[k].name for k in own)
            continue
        in_bodies.update(own)
        columns.extend(slice(k, k + BODY_PARAMETERS) for k in own[::BODY_PARAMETERS])
    if not columns:
        raise EstimationFailed("no body is unknown in this torque model: there is nothing to keep consistent")
    mean = (prior or model_prior(torque_model)).mean
    ten = np.stack([mean[part] for part in columns])
    for payload, carrier in carriers.items():
        if not ten[payload].any():
            ten[payload] = model.bodies[carrier].parameters
    inside = inertial_prior(ten)
    moved = ", ".join(name for name, lifted in zip(names, inside.lifted, strict=True) if lifted)
    further = tuple(column.name for k, column in enumerate(torque_model.columns) if k not in in_bodies)
    remark = f"no real body has the prior inertia of {moved}; it was made heavier or thicker" if moved else ""
    return Bodies(
        tuple(names), tuple(columns), inside.pseudo_inertia, further, tuple(nonnegative), (remark,) if remark else ()
    )
