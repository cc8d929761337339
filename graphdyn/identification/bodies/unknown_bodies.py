"""Columns of every unknown body in a torque model, their prior and reach, and columns that cannot be negative."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.bodies.reach import extents, gyration_radii, joined, reach_boxes, spreads
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
from graphdyn.model.inertia import pseudo_inertia_from_parameters

NONNEGATIVE_TERMS = (
    *(Viscous, Coulomb, AsymmetricViscous, AsymmetricCoulomb, LoadFriction, MaxwellSlip),
    *(RotorInertia, PayloadMass),
)
"""Terms whose parameters cannot be negative: friction dissipates energy, a rotor has mass. Stribeck friction may fall
below zero, because it adds to Coulomb friction."""

PAYLOAD = "payload"
"""Name of an unknown load among the bodies."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """The unknown bodies of a torque model.

    names (n,), columns (n,): their ten parameters
    prior: pseudo-inertia matrices, positive definite       (n, 4, 4)
    cad_mass: mass that CAD, or another prior, gives; NaN for a body that it does not know    (n,) [kg]
    reach: boxes that hold the bodies, by the kinematics and the prior, in link axes    (n, 2, 3) [m]
    radius: largest radius of gyration, by the kinematics and the prior     (n,)    [m]
    further: names of the columns that belong to no body, in their order      (k,)
    nonnegative: those of them that cannot be negative
    remarks: changes of the prior, in sentences
    """

    names: tuple[str, ...]
    columns: tuple[slice, ...]
    prior: Array
    cad_mass: Array
    reach: Array
    radius: Array
    further: tuple[str, ...]
    nonnegative: tuple[str, ...]
    remarks: tuple[str, ...]


def unknown_bodies(torque_model: TorqueModel, prior: Prior | None) -> Bodies:
    """Unknown bodies of a torque model, with their prior.

    prior: its mean is read; the parameters of the model if left out. A payload that it does not contain (zero) is
    expected to be like the body that carries it.

    Raises EstimationFailed if no body is unknown, InvalidInput if no body of the prior has a mass.
    """
    model = torque_model.model
    names: list[str] = []
    columns: list[slice] = []
    nonnegative: list[str] = []
    in_bodies: set[int] = set()
    carriers: dict[int, int] = {}
    for term, part in torque_model.parts:
        own = range(part.start, part.stop)
        if isinstance(term, Payload):
            carriers[len(names)] = model.body_names.index(term.body) if term.body else model.n_bodies - 1
            names.append(PAYLOAD)
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
    cad_mass = np.where(ten[:, 0] > 0, ten[:, 0], np.nan)
    for payload, carrier in carriers.items():
        if not ten[payload].any():
            ten[payload] = model.bodies[carrier].parameters
    inside, lifted = inertial_prior(ten)
    numbers = [carriers[k] if k in carriers else model.body_names.index(name) for k, name in enumerate(names)]
    reach, radius = reach_boxes(model)[numbers], gyration_radii(model)[numbers]
    moved = ", ".join(name for name, light in zip(names, lifted, strict=True) if light)
    further = tuple(column.name for k, column in enumerate(torque_model.columns) if k not in in_bodies)
    remark = f"no real body has the prior inertia of {moved}; it was made heavier or thicker" if moved else ""
    return Bodies(
        tuple(names),
        tuple(columns),
        inside,
        cad_mass,
        joined(reach, extents(inside)),
        np.where(spreads(inside) > radius, WIDE_PRIOR_FACTOR * spreads(inside), radius),
        further,
        tuple(nonnegative),
        (remark,) if remark else (),
    )


WIDE_PRIOR_FACTOR = 1.5
"""Largest radius of gyration relative to that of a prior that is itself wider than its link should be."""


MIN_PRIOR_RADIUS = 1e-3
"""Smallest extent of a prior [m]: the root mean square distance of its mass from a plane through the center of mass."""


MIN_PRIOR_THINNESS = 0.05
"""Smallest extent of a prior relative to its largest one: the log-det of a flat or slender CAD body is undefined."""


MIN_PRIOR_MASS_SHARE = 1e-2
"""Smallest mass of a prior relative to the mean body: a link without mass in the file gets that much."""


def inertial_prior(parameters: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Positive definite pseudo-inertia matrices (n, 4, 4) of a prior (n, 10), and which of them had to be lifted (n,).

    A body that is too light, too thin or not physically consistent is moved inside the consistent ones. The mass is
    raised to MIN_PRIOR_MASS_SHARE of the mean, and the extent along each principal axis to MIN_PRIOR_THINNESS of the
    largest one and to MIN_PRIOR_RADIUS. A body that is already inside stays unchanged.
    Raises InvalidInput if no body has a mass.
    """
    mass = parameters[:, 0]
    heavy = mass > 0
    if not heavy.any():
        raise InvalidInput("no body of the prior has a mass; give a prior with at least rough masses")
    matrices = pseudo_inertia_from_parameters(parameters)
    least = MIN_PRIOR_MASS_SHARE * mass[heavy].mean()
    lifted = np.array([_lift(matrix, least) for matrix in matrices])
    return matrices, lifted


def _lift(matrix: Array, least_mass: float) -> bool:
    """Move one pseudo-inertia matrix inside, in place; return whether that was needed."""
    light = matrix[3, 3] < least_mass
    center = np.zeros(3) if matrix[3, 3] <= 0 else matrix[:3, 3] / matrix[3, 3]
    second_moments = matrix[:3, :3] - matrix[3, 3] * np.outer(center, center)
    mass = max(matrix[3, 3], least_mass)
    values, axes = np.linalg.eigh(second_moments)
    smallest = max(MIN_PRIOR_THINNESS**2 * values[-1], MIN_PRIOR_RADIUS**2 * mass)
    if not light and values[0] >= smallest:
        return False
    second_moments = axes * np.maximum(values, smallest) @ axes.T
    matrix[:3, :3] = second_moments + mass * np.outer(center, center)
    matrix[:3, 3] = matrix[3, :3] = mass * center
    matrix[3, 3] = mass
    return True
