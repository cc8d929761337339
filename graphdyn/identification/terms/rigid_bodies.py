"""The rigid bodies: ten parameters each, unknown or known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.terms.term import TermParameter
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.inertia import PARAMETER_NAMES
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
        return joint_torque_regressor(model, samples.q, samples.v, samples.a, base=samples.base)

    def inertial_parameters(self, model: RobotModel, x: Array) -> Array:
        return x


@dataclass(frozen=True, eq=False)
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
