"""Limits on what bodies may be: masses near those of CAD, all of their matter within a box.

A positive mass is not yet a plausible one. Base parameters leave most masses of an arm open, and a torque model that
lacks something drives them anywhere that the cone of real bodies allows. By default a mass stays within CAD_FACTOR of
CAD, the sum of all masses within its root, because errors of single masses do not all go the same way.

Matter between two planes, low ≤ x ≤ high, has ∫ (x - low)(high - x) dm ≥ 0, which is linear in the inertial parameters:

    (low + high) m c - ∫ x² dm - low high m ≥ 0

It bounds the center of mass and the second moments about it at once, (c - low)(high - c) ≥ ∫ (x - c)² dm / m. Three of
them hold a body in a box, and ∫ |x - c₀|² dm ≤ r² m bounds its radius of gyration (Wensing, Kim and Slotine, IEEE
Robotics and Automation Letters 3(1), 2018, section IV, with planes in place of an ellipsoid).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.bodies.reach import extents, joined
from graphdyn.identification.bodies.unknown_bodies import PAYLOAD, Bodies
from graphdyn.layout import Array
from graphdyn.model.inertia import parameters_from_pseudo_inertia, pseudo_inertia_from_parameters

CAD_FACTOR = 3.0
"""Largest ratio of a mass and that of CAD, in both directions. Drawings without motors, gears or cables are wrong by a
factor of two; by more only where CAD is of another robot, or a placeholder."""

AT_LIMIT_SHARE = 0.02
"""Distance from a limit, relative to a mass or to the side of a box, within which the limit holds a value, and not the
recording."""

MIN_EQUAL_BODIES = 3
"""Number of bodies from which equal masses and tensors are placeholders."""


@dataclass(frozen=True, eq=False)
@short_repr
class PhysicalLimits:
    """Bounds on the bodies, by name ("payload" for an unknown payload).

    mass: lowest and highest mass (2,) of a body, in place of those by CAD      [kg]
    center: box that holds the center of mass of a body, lower and upper corner in link axes from the link origin (2, 3)
                                                            [m]
    total_mass: lowest and highest sum of the unknown masses (2,), in place of those by CAD     [kg]
    cad_factor: largest ratio of a mass and that of the prior; infinity for none
    cad_factors: the same of single bodies
    box: boxes that hold all matter of a body (2, 3), from its meshes; in place of its reach, by the kinematics     [m]
    in_boxes: whether matter stays within the boxes, and its spread within the size of the link
    """

    mass: Mapping[str, ArrayLike] = field(default_factory=dict)
    center: Mapping[str, ArrayLike] = field(default_factory=dict)
    total_mass: ArrayLike | None = None
    cad_factor: float = CAD_FACTOR
    cad_factors: Mapping[str, float] = field(default_factory=dict)
    box: Mapping[str, ArrayLike] = field(default_factory=dict)
    in_boxes: bool = True

    @property
    def stated(self) -> bool:
        """Whether anything differs from what holds by default."""
        given = self.mass or self.center or self.cad_factors or self.box or self.total_mass is not None
        return bool(given) or self.cad_factor != CAD_FACTOR or not self.in_boxes

    def of(self, bodies: Bodies) -> BodyLimits:
        """The limits of these bodies. Boxes are widened to hold the prior.

        Raises InvalidInput, naming the body, for an unknown body, a wrong shape, a lower bound above the upper one, a
        factor below 1.
        """
        names = bodies.names
        given = {"mass": self.mass, "center": self.center, "CAD factor": self.cad_factors, "box": self.box}
        for what, named in given.items():
            for name in named:
                _refuse_unknown(bodies, name, what)
        factors = np.array([_factor(name, self.cad_factors.get(name, self.cad_factor)) for name in names])
        cad, remarks = _trusted(bodies, factors)
        known = np.isfinite(cad)
        mass = np.where(known[:, None], np.stack([cad / factors, cad * factors], axis=1), [0.0, np.inf])
        # a body that CAD does not know counts in the sum with the mass of its lifted prior, a load does not
        light, root = bodies.prior[:, 3, 3], np.sqrt(factors)
        parts = np.stack([np.where(known, light / root, 0.0), light * root], axis=1)
        for name, bounds in self.mass.items():
            k = names.index(name)
            mass[k] = parts[k] = _bounds(f"mass of '{name}'", bounds, (2,), "kg")
        counted = np.array([name != PAYLOAD for name in names])
        total = parts[counted].sum(axis=0) if known.any() else np.array([0.0, np.inf])
        if self.total_mass is not None:
            counted, total = np.full(len(names), True), _bounds("total mass", self.total_mass, (2,), "kg")
        center = np.tile([[-np.inf], [np.inf]], (len(names), 1, 3))
        for name, box in self.center.items():
            center[names.index(name)] = _bounds(f"center of mass of '{name}'", box, (2, 3), "m")
        boxes = np.tile([[-np.inf], [np.inf]], (len(names), 1, 3))
        if self.in_boxes:
            boxes = bodies.reach.copy()
            for name, box in self.box.items():
                k = names.index(name)
                boxes[k] = joined(_bounds(f"box of '{name}'", box, (2, 3), "m"), extents(bodies.prior)[k])
        radius = bodies.radius if self.in_boxes else np.full(len(names), np.inf)
        about = bodies.prior[:, :3, 3] / bodies.prior[:, 3, 3, None]
        return BodyLimits(names, bodies.columns, mass, center, total, counted, boxes, radius, about, cad, remarks)


def _factor(name: str, factor: float) -> float:
    if not factor >= 1:
        raise InvalidInput(f"CAD factor of '{name}' is {factor:g}; give a number of 1 or more, inf for none")
    return float(factor)


def _trusted(bodies: Bodies, factors: Array) -> tuple[Array, tuple[str, ...]]:
    """Masses of CAD that limit something, NaN for the others (n,), and why some do not."""
    cad = np.where(np.isfinite(factors), bodies.cad_mass, np.nan)
    own = np.array([name != PAYLOAD for name in bodies.names])
    tensors = parameters_from_pseudo_inertia(_central(bodies.prior[own]))
    if len(tensors) >= MIN_EQUAL_BODIES and np.ptp(tensors, axis=0).max() <= 1e-9 * np.abs(tensors).max():
        remark = "all bodies of CAD have the same mass and tensor, placeholders: they limit no mass"
        return np.full(len(cad), np.nan), (remark,)
    without = [name for name, mass in zip(bodies.names, bodies.cad_mass, strict=True) if np.isnan(mass)]
    massless = [name for name in without if name != PAYLOAD]
    if massless:
        return cad, (f"CAD has no mass of {', '.join(massless)}: only the total mass limits it",)
    return cad, ()


def _central(matrices: Array) -> Array:
    """Pseudo-inertia matrices about the centers of mass."""
    moved = matrices.copy()
    center = matrices[:, :3, 3] / matrices[:, 3, 3, None]
    moved[:, :3, :3] -= matrices[:, 3, 3, None, None] * center[:, :, None] * center[:, None, :]
    moved[:, :3, 3] = moved[:, 3, :3] = 0.0
    return moved


@dataclass(frozen=True)
class ReachedLimit:
    """A value within AT_LIMIT_SHARE of its limit: the recording does not determine it, or contradicts the limit.

    body: empty for the total mass
    quantity: "mass", "total mass", "center of mass in x", "radius of gyration in x" (root mean square distance from the
        center)
    value, limit: the value and its limit [kg or m]
    """

    body: str
    quantity: str
    value: float
    limit: float


def _near_ratio(value: float, bounds: Array) -> list[float]:
    """The bound that a mass comes near."""
    low, high = map(float, bounds)
    if value <= low * (1 + AT_LIMIT_SHARE):
        return [low]
    return [high] if value >= high * (1 - AT_LIMIT_SHARE) else []


@dataclass(frozen=True, eq=False)
@short_repr
class BodyLimits:
    """Limits of the unknown bodies of a torque model; infinite where there is none.

    names (n,), columns (n,): their ten parameters
    mass: lowest and highest                                (n, 2)  [kg]
    center: box of the center of mass, in link axes         (n, 2, 3)  [m]
    total_mass: lowest and highest sum of those counted     (2,)    [kg]
    counted: bodies of this sum                             (n,)
    box: box of all matter, in link axes                    (n, 2, 3)  [m]
    radius: root mean square distance of the matter from the point `about`      (n,)    [m]
    about: the center of mass of the prior, in link axes    (n, 3)  [m]
    cad_mass: mass of CAD that limits, NaN if none does     (n,)    [kg]
    remarks: why CAD limits nothing, in sentences
    """

    names: tuple[str, ...]
    columns: tuple[slice, ...]
    mass: Array
    center: Array
    total_mass: Array
    counted: NDArray[np.bool_]
    box: Array
    radius: Array
    about: Array
    cad_mass: Array
    remarks: tuple[str, ...]

    def reached(self, parameters: Array) -> tuple[ReachedLimit, ...]:
        """The limits that these parameters (p,) of the torque model come near: within AT_LIMIT_SHARE."""
        ten = np.array([parameters[part] for part in self.columns])
        mass = ten[:, 0]
        found = []
        for name, value, bounds in zip(self.names, mass, self.mass, strict=True):
            found += [ReachedLimit(name, "mass", float(value), limit) for limit in _near_ratio(value, bounds)]
        total = float(mass[self.counted].sum())
        found += [ReachedLimit("", "total mass", total, limit) for limit in _near_ratio(total, self.total_mass)]
        matrices = pseudo_inertia_from_parameters(ten)
        centers = ten[:, 1:4] / mass[:, None]
        spreads = np.einsum("nkk->nk", matrices[:, :3, :3]) / mass[:, None] - centers**2
        lower, upper = (np.maximum(self.center[:, 0], self.box[:, 0]), np.minimum(self.center[:, 1], self.box[:, 1]))
        for i, name in enumerate(self.names):
            for k, axis in enumerate("xyz"):
                low, high, center = lower[i, k], upper[i, k], float(centers[i, k])
                if not np.isfinite(low) or not np.isfinite(high):
                    continue
                near = AT_LIMIT_SHARE * (high - low)
                room = (center - self.box[i, 0, k]) * (self.box[i, 1, k] - center)
                if not low + near < center < high - near:
                    limit = float(low if center - low < high - center else high)
                    found.append(ReachedLimit(name, f"center of mass in {axis}", center, limit))
                elif spreads[i, k] >= (1 - AT_LIMIT_SHARE) ** 2 * room:
                    sizes = float(np.sqrt(spreads[i, k])), float(np.sqrt(room))
                    found.append(ReachedLimit(name, f"radius of gyration in {axis}", *sizes))
        return tuple(found)


def _refuse_unknown(bodies: Bodies, name: str, bounded: str) -> None:
    if name not in bodies.names:
        raise InvalidInput(
            f"{bounded} limits of '{name}', which is not an unknown body; known: {', '.join(bodies.names)}"
        )


def _bounds(what: str, given: ArrayLike, shape: tuple[int, ...], unit: str) -> Array:
    bounds = as_floats(what, given)
    if bounds.shape != shape or np.any(np.isnan(bounds)):
        raise InvalidInput(f"limits of the {what} are {bounds.tolist()}; [lower, upper] of shape {shape} needed")
    if np.any(bounds[0] > bounds[1]):
        raise InvalidInput(f"{what}: the lower limit {bounds[0]} is above the upper limit {bounds[1]} {unit}")
    return bounds
