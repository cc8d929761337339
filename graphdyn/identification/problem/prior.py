"""Prior knowledge of the parameters: a mean with a spread, for instance from CAD, and expected single values.

Expected values are further equations in addition to those of the recording. A parameter that is itself a base
parameter is one unknown of the recording. Of the others the recording determines only sums, to which an expected value
of one part adds no information.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.display import short_repr
from graphdyn.identification.algebra.base_parameters import BaseParameters
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
@short_repr
class Prior:
    """Parameters expected before the measurement.

    mean: expected values                                   (p,)
    scale: expected distance from them, infinite if nothing is known   (p,)
    """

    mean: Array
    scale: Array

    def nearest(self, base: BaseParameters, values: Array) -> Array:
        """The parameters (p,) with these base parameters that are nearest to the mean, in units of the scale.

        A column without a scale counts as 1 in its own unit.
        """
        scale = np.where(np.isfinite(self.scale), self.scale, 1.0)
        b = base.matrix * scale
        step, *_ = np.linalg.lstsq(b, values - base.values(self.mean), rcond=None)
        mean: Array = self.mean + scale * step
        return mean


def model_prior(torque_model: TorqueModel) -> Prior:
    """The inertial parameters of the model, with scales m, m l and m l² by unit; nothing is known of the rest.

    m is the mean mass of its bodies (1 kg if there are none), l the mean distance of its joints (likewise 1 m).
    """
    model = torque_model.model
    mass = float(np.mean([body.mass for body in model.bodies])) or 1.0
    length = float(np.mean([np.linalg.norm(joint.placement.translation) for joint in model.joints])) or 1.0
    scales = {"kg": mass, "kg m": mass * length, "kg m²": mass * length**2}
    return Prior(torque_model.prior(), np.array([scales.get(column.unit, np.inf) for column in torque_model.columns]))


def expected_equations(torque_model: TorqueModel, base: BaseParameters) -> Array | None:
    """x_k / deviation = value / deviation in base parameters of the recording (k, r + 1); None if there are none."""
    columns, values, deviations = torque_model.expectations()
    alone = np.isin(columns, base.alone)
    if not alone.any():
        return None
    rows = np.column_stack([base.matrix.T[columns], values])[alone]
    return np.asarray(rows / deviations[alone, None])


def without_effect(torque_model: TorqueModel, base: BaseParameters) -> tuple[str, ...]:
    """Symbols of the expected parameters that are not base parameters themselves."""
    columns, *_ = torque_model.expectations()
    pairs = zip(torque_model.expected, np.isin(columns, base.alone), strict=True)
    return tuple(symbol for symbol, alone in pairs if not alone)
