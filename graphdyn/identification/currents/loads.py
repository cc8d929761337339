"""A load on a link: what is known of it beforehand, and what was identified."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import inertia_from_parameters, pseudo_inertia_from_parameters

WEIGHED = 1e-3
"""Relative standard deviation of a mass that was weighed: a gram per kilogram, as kitchen scales have it."""

MEASURED_CENTER = 1e-3
"""Standard deviation of each coordinate of a center of mass that is known [m]: the error of a clamped part."""

MIN_DEVIATIONS = 3.0
"""Standard deviations of a mass above which there is a load: without one, the mass is beyond two in one of twenty
recordings, and beyond three in one of four hundred."""


@dataclass(frozen=True)
class KnownLoad:
    """What is known of a load that calibrates gains; the rest is found with them.

    mass: [kg]
    center_of_mass: in the frame of the link that carries it, None if unknown    (3,)   [m]

    Raises InvalidInput for a mass that is not above zero.
    """

    mass: float
    center_of_mass: tuple[float, float, float] | None = None

    def __post_init__(self) -> None:
        if not 0 < self.mass < np.inf:
            raise InvalidInput(f"the mass of the known load is {self.mass:g} kg; give one above zero")

    def equations(self) -> tuple[Array, Array]:
        """Rows A (k, 10) and right side b (k,) of A π = b in units of the deviations: mass, and center times mass."""
        rows, right = np.zeros((4, BODY_PARAMETERS)), np.zeros(4)
        rows[0, 0], right[0] = 1 / (WEIGHED * self.mass), 1 / WEIGHED
        if self.center_of_mass is None:
            return rows[:1], right[:1]
        rows[1:, 1:4] = np.eye(3) / (MEASURED_CENTER * self.mass)
        rows[1:, 0] = -np.array(self.center_of_mass) / (MEASURED_CENTER * self.mass)
        return rows, right


@dataclass(frozen=True, eq=False)
@short_repr
class IdentifiedLoad:
    """A load identified from recordings.

    parameters: in the frame of the link that carries it    (10,)
    covariance: of the parameters; it contains the uncertainty of the gains   (10, 10)
    """

    parameters: Array
    covariance: Array

    @property
    def mass(self) -> float:
        """The mass [kg]."""
        return float(self.parameters[0])

    @property
    def center_of_mass(self) -> Array:
        """The center of mass in the frame of the link (3,) [m]."""
        return np.asarray(self.parameters[1:4] / self.mass)

    @property
    def inertia(self) -> Array:
        """The tensor about the center of mass, in axes of the link (3, 3) [kg m²]."""
        return inertia_from_parameters(self.parameters)[2]

    @property
    def mass_deviation(self) -> float:
        """The standard deviation of the mass [kg]."""
        return float(np.sqrt(self.covariance[0, 0]))

    @property
    def center_deviations(self) -> Array:
        """The standard deviations of the center of mass (3,) [m]."""
        step = np.zeros((3, BODY_PARAMETERS))
        step[:, 0], step[:, 1:4] = -self.center_of_mass / self.mass, np.eye(3) / self.mass
        return _deviations(step, self.covariance)

    @property
    def inertia_deviations(self) -> Array:
        """The standard deviations of the tensor about the center of mass (3, 3) [kg m²]."""
        c, unit = self.center_of_mass, np.eye(3)
        step = np.zeros((3, 3, BODY_PARAMETERS))
        for k in range(BODY_PARAMETERS):  # I_c = I_o - (h·h 1 - h hᵀ) / m, linear in I_o
            one = np.zeros(BODY_PARAMETERS)
            one[k] = 1.0
            moment = one[1:4]
            step[..., k] = -(2 * c @ moment * unit - np.outer(c, moment) - np.outer(moment, c))
            step[..., k] += one[0] * (c @ c * unit - np.outer(c, c))
            step[..., k] += [[one[4], one[5], one[7]], [one[5], one[6], one[8]], [one[7], one[8], one[9]]]
        return _deviations(step.reshape(9, -1), self.covariance).reshape(3, 3)

    @property
    def determined(self) -> bool:
        """Whether the mass is above three times its standard deviation."""
        return self.mass > MIN_DEVIATIONS * self.mass_deviation

    @property
    def below_zero(self) -> bool:
        """Whether the mass is below zero by more than three times its standard deviation."""
        return self.mass < -MIN_DEVIATIONS * self.mass_deviation

    @property
    def consistent(self) -> bool:
        """Whether some real body has these parameters."""
        return bool(np.linalg.eigvalsh(pseudo_inertia_from_parameters(self.parameters)).min() > 0)


def _deviations(step: Array, covariance: Array) -> Array:
    """Standard deviations of values whose derivatives by the parameters are the rows of `step`."""
    used = np.any(step != 0, axis=0)  # what has no effect may be undetermined
    if not np.all(np.isfinite(covariance[used][:, used])):
        return np.full(len(step), np.inf)
    found: Array = np.sqrt(np.einsum("ij,jk,ik->i", step[:, used], covariance[np.ix_(used, used)], step[:, used]))
    return found
