"""Parameters that are known beforehand, as further equations beside those of the recording.

A parameter that stands alone among the base parameters is one unknown of the recording; of others the recording shows
sums alone, to which an expected value of one part adds nothing.
"""

from __future__ import annotations

import numpy as np

from graphdyn.identification.base_parameters import BaseParameters
from graphdyn.identification.torque_model import TorqueModel
from graphdyn.layout import Array


def expected_equations(torque_model: TorqueModel, base: BaseParameters) -> Array | None:
    """x_k / deviation = value / deviation in base parameters of the recording (k, r + 1); None without any."""
    columns, values, deviations = torque_model.expectations()
    alone = np.isin(columns, base.alone)
    if not alone.any():
        return None
    rows = np.column_stack([base.matrix.T[columns], values])[alone]
    return np.asarray(rows / deviations[alone, None])


def without_effect(torque_model: TorqueModel, base: BaseParameters) -> tuple[str, ...]:
    """Symbols of the expected parameters that do not stand alone."""
    columns, *_ = torque_model.expectations()
    pairs = zip(torque_model.expected, np.isin(columns, base.alone), strict=True)
    return tuple(symbol for symbol, alone in pairs if not alone)
