"""The rigid bodies, unknown or known, and a load on one of them: known, unknown, or with only its mass unknown.

The parameters of a load are in the link frame of the body that carries the load. If the parameters of payload and body
are both unknown, only their sums are determined, and the base parameters show it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.compiler.running import quick_for_few
from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.term import TermParameter
from graphdyn.layout import BODY_PARAMETERS, Array, parameter_columns
from graphdyn.model.inertia import PARAMETER_NAMES, parameters_from_inertia
from graphdyn.model.robot_model import RobotModel
from graphdyn.verbs.matrices import joint_torque_regressor

PARAMETER_SYMBOLS = ("M", "MX", "MY", "MZ", "XX", "XY", "YY", "XZ", "YZ", "ZZ")
PARAMETER_UNITS = ("kg", *["kg m"] * 3, *["kg m²"] * 6)


@dataclass(frozen=True)
class RigidBodies:
    """Ten unknown inertial parameters per body, in the order and frames of Body.parameters."""

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return tuple(
            column for i, name in enumerate(model.body_names, start=1) for column in inertial_columns(name, str(i))
        )

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        with quick_for_few(model, "joint_torque_regressor", len(samples.q)) as method:
            return joint_torque_regressor(model, samples.q, samples.v, samples.a, base=samples.base, method=method)

    def inertial_parameters(self, model: RobotModel, x: Array) -> Array:
        return x


@dataclass(frozen=True, eq=False)
@short_repr
class KnownBodies:
    """Bodies whose parameters are known, for instance from CAD: their torque is subtracted.

    parameters: (10 n,), those of the model if left out. Raises InvalidInput for any other shape.
    """

    parameters: ArrayLike | None = None

    def torque(self, model: RobotModel, samples: Samples) -> Array:
        return RigidBodies().rows(model, samples) @ self._values(model)

    def known_inertial_parameters(self, model: RobotModel) -> Array:
        return self._values(model)

    def _values(self, model: RobotModel) -> Array:
        if self.parameters is None:
            return model.inertial_parameters
        return ten_parameters("known bodies", self.parameters, model.n_bodies)


def inertial_columns(name: str, number: str) -> tuple[TermParameter, ...]:
    """Columns of one rigid body."""
    return tuple(
        TermParameter(f"{name} {parameter}", f"{symbol}_{number}", unit)
        for parameter, symbol, unit in zip(PARAMETER_NAMES, PARAMETER_SYMBOLS, PARAMETER_UNITS, strict=True)
    )


def ten_parameters(who: str, values: ArrayLike, bodies: int = 1) -> Array:
    """Finite parameters (10 · bodies,). Raises InvalidInput."""
    array = as_floats(f"parameters of the {who}", values)
    if array.shape != (BODY_PARAMETERS * bodies,) or not np.all(np.isfinite(array)):
        raise InvalidInput(
            f"parameters of the {who} have shape {array.shape}; {BODY_PARAMETERS * bodies} finite numbers needed, "
            f"{', '.join(PARAMETER_NAMES)} per body"
        )
    return array


@dataclass(frozen=True)
class Payload:
    """Ten unknown parameters of a load on a body, the last one if left out."""

    body: str | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        carrier(model, self.body)
        return inertial_columns("payload", "L")

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return RigidBodies().rows(model, samples)[..., parameter_columns(carrier(model, self.body))]

    def inertial_parameters(self, model: RobotModel, x: Array) -> Array:
        return on_carrier(model, self.body, x)


@dataclass(frozen=True, eq=False)
@short_repr
class PayloadMass:
    """One unknown: the mass of a load whose center, and tensor per mass about it, are known.

    center_of_mass: in the link frame of the body           (3,)    [m]
    inertia_per_mass: about the center; a point if left out (3, 3)  [m²]
    """

    center_of_mass: ArrayLike
    inertia_per_mass: ArrayLike = field(default_factory=lambda: np.zeros((3, 3)))
    body: str | None = None

    def columns(self, model: RobotModel) -> tuple[TermParameter, ...]:
        return (TermParameter("payload m", "M_L", "kg"),)

    def rows(self, model: RobotModel, samples: Samples) -> Array:
        return (Payload(self.body).rows(model, samples) @ self._per_mass())[..., None]

    def inertial_parameters(self, model: RobotModel, x: Array) -> Array:
        return on_carrier(model, self.body, x[0] * self._per_mass())

    def _per_mass(self) -> Array:
        center = as_floats("center of mass of the payload", self.center_of_mass)
        inertia = as_floats("inertia per mass of the payload", self.inertia_per_mass)
        if center.shape != (3,) or inertia.shape != (3, 3):
            raise InvalidInput(
                f"center of mass of the payload has shape {center.shape}, inertia per mass {inertia.shape}; "
                "(3,) and (3, 3) needed"
            )
        return parameters_from_inertia(1.0, center, inertia)


@dataclass(frozen=True, eq=False)
@short_repr
class KnownPayload:
    """A load with known parameters (10,); its torque is subtracted. Raises InvalidInput for any other shape."""

    parameters: ArrayLike
    body: str | None = None

    def torque(self, model: RobotModel, samples: Samples) -> Array:
        return Payload(self.body).rows(model, samples) @ ten_parameters("payload", self.parameters)

    def known_inertial_parameters(self, model: RobotModel) -> Array:
        return on_carrier(model, self.body, ten_parameters("payload", self.parameters))


def carrier(model: RobotModel, body: str | None) -> int:
    """Number of the body that carries the load. Raises InvalidInput for an unknown one."""
    if body is None:
        return model.n_bodies
    if body not in model.body_names:
        raise InvalidInput(f"the payload is on body '{body}'; robot '{model.name}' has {', '.join(model.body_names)}")
    return model.body_names.index(body) + 1


def on_carrier(model: RobotModel, body: str | None, parameters: Array) -> Array:
    everything = np.zeros(BODY_PARAMETERS * model.n_bodies)
    everything[parameter_columns(carrier(model, body))] = parameters
    return everything
