"""Columns of every unknown body in a torque model, other columns that cannot be negative, and limits on both."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import EstimationFailed, InvalidInput
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
    inside, lifted = inertial_prior(ten)
    moved = ", ".join(name for name, light in zip(names, lifted, strict=True) if light)
    further = tuple(column.name for k, column in enumerate(torque_model.columns) if k not in in_bodies)
    remark = f"no real body has the prior inertia of {moved}; it was made heavier or thicker" if moved else ""
    return Bodies(tuple(names), tuple(columns), inside, further, tuple(nonnegative), (remark,) if remark else ())


@dataclass(frozen=True, eq=False)
class PhysicalLimits:
    """Bounds on the bodies, by name ("payload" for an unknown payload); infinite if there is none on one side.

    mass: lowest and highest mass (2,) of a body            [kg]
    center: box that holds the center of mass of a body, lower and upper corner in link axes from the link origin (2, 3)
                                                            [m]
    total_mass: lowest and highest sum of the unknown masses (2,)  [kg]
    """

    mass: Mapping[str, ArrayLike] = field(default_factory=dict)
    center: Mapping[str, ArrayLike] = field(default_factory=dict)
    total_mass: ArrayLike = (-np.inf, np.inf)


@dataclass(frozen=True, eq=False)
class Inequalities:
    """G x ≥ h of the parameters x of a torque model.

    matrix: G (m, p); right: h (m,); names: each as text    (m,)
    """

    matrix: Array
    right: Array
    names: tuple[str, ...]


def inequalities(limits: PhysicalLimits, bodies: Bodies, columns: Sequence[str]) -> Inequalities:
    """The limits as inequalities, with the columns that cannot be negative. columns: names of all p.

    Raises InvalidInput, naming the body, for an unknown body, a wrong shape, a lower bound above the upper one.
    """
    rows: list[tuple[dict[int, float], float, str]] = []

    def mass_between(masses: Sequence[int], bounds: ArrayLike, what: str) -> None:
        low, high = _bounds(what, bounds, (2,), "kg")
        rows.append((dict.fromkeys(masses, 1.0), low, f"{what} ≥ {low:g} kg"))
        rows.append((dict.fromkeys(masses, -1.0), -high, f"{what} ≤ {high:g} kg"))

    for name, bounds in limits.mass.items():
        mass_between([_mass(bodies, name, "mass")], bounds, f"mass of '{name}'")
    mass_between([part.start for part in bodies.columns], limits.total_mass, "total mass")
    for name, box in limits.center.items():
        mass, what = _mass(bodies, name, "center"), f"center of mass of '{name}'"
        for axis, (low, high) in enumerate(_bounds(what, box, (2, 3), "m").T):
            moment, of_axis = mass + 1 + axis, f"{what} in {'xyz'[axis]}"
            if np.isfinite(low):  # m c ≥ low m
                rows.append(({moment: 1.0, mass: -low}, 0.0, f"{of_axis} ≥ {low:g} m"))
            if np.isfinite(high):
                rows.append(({moment: -1.0, mass: high}, 0.0, f"{of_axis} ≤ {high:g} m"))
    rows.extend(({columns.index(name): 1.0}, 0.0, f"{name} ≥ 0") for name in bodies.nonnegative)

    given = [row for row in rows if np.isfinite(row[1])]
    matrix = np.zeros((len(given), len(columns)))
    for line, (coefficients, _, _) in zip(matrix, given, strict=True):
        line[list(coefficients)] = list(coefficients.values())
    return Inequalities(matrix, np.array([right for _, right, _ in given]), tuple(name for _, _, name in given))


def _mass(bodies: Bodies, name: str, bounded: str) -> int:
    """Column of a body's mass."""
    if name not in bodies.names:
        raise InvalidInput(
            f"{bounded} limits of '{name}', which is not an unknown body; known: {', '.join(bodies.names)}"
        )
    first: int = bodies.columns[bodies.names.index(name)].start
    return first


def _bounds(what: str, given: ArrayLike, shape: tuple[int, ...], unit: str) -> Array:
    bounds = as_floats(what, given)
    if bounds.shape != shape or np.any(np.isnan(bounds)):
        raise InvalidInput(f"limits of the {what} are {bounds.tolist()}; [lower, upper] of shape {shape} needed")
    if np.any(bounds[0] > bounds[1]):
        raise InvalidInput(f"{what}: the lower limit {bounds[0]} is above the upper limit {bounds[1]} {unit}")
    return bounds


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
