"""Agreement of the two halves of a recording: with common parameters, and with separate ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from graphdyn.identification.data.samples import Samples
from graphdyn.identification.data_quality.bounded_fit import BoundedFit
from graphdyn.identification.problem.torque_model import TorqueModel
from graphdyn.layout import Array

MIN_CONTRADICTION, MIN_WORTH = 2.0, 0.2
"""Residual of the common fit from which the halves of a recording contradict each other: as a multiple of that of their
separate fits, and as a fraction of the torque."""


def halves_apart(torque_model: TorqueModel, samples: Samples, fit: BoundedFit) -> Array:
    """Errors of the common and of the separate fit, of the first and of the second half (2, 2, n)."""
    x, middle = fit.parameters(samples.tau), len(samples) // 2
    errors = []
    for rows in (slice(None, middle), slice(middle, None)):
        half = samples[rows]
        own = BoundedFit.of(torque_model, half, fit.kept[rows])
        size = np.linalg.norm(np.where(own.kept, half.tau, 0.0), axis=0)
        common = np.linalg.norm(np.nan_to_num(own.residual(half.tau, x)), axis=0) / np.where(size > 0, size, 1.0)
        errors.append([common, own.errors(half.tau)])
    return np.array(errors)


def contradictions(halves: Array) -> NDArray[np.bool_]:
    """Halves and joints where a recording contradicts its other half (2, n). halves: of RecordingQuality."""
    common, own = halves[:, 0], halves[:, 1]
    return np.asarray(common > np.maximum(MIN_CONTRADICTION * own, MIN_WORTH))
