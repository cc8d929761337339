"""The rows from which the small arm is identified, by SciPy and the regressor of graphdyn."""

from typing import NamedTuple

import numpy as np
from scipy.signal import butter, sosfiltfilt

from graphdyn import joint_torque_regressor

RATE, CUTOFF, WIDTH, CUT = 250.0, 10.0, 0.05, 76


class OwnRows(NamedTuple):
    """Velocities (N, n), regressor of all parameters (N, n, p), torques (N, n), all low-passed."""

    v: np.ndarray
    regressor: np.ndarray
    tau: np.ndarray


def own_rows(model, recording):
    """v and a by differences of fourth order, both friction terms; torques are filtered without the borders."""
    q = _low(recording.q)
    v = _slope(q)
    q, v, a = (x[CUT:-CUT] for x in (q, v, _slope(v)))
    friction = [x[:, :, None] * np.eye(model.nv) for x in (v, np.tanh(v / WIDTH))]
    regressor = np.concatenate([joint_torque_regressor(model, q, v, a), *friction], axis=-1)
    return OwnRows(_low(v), _low(regressor), _low(recording.tau[CUT:-CUT]))


def _low(values):
    return sosfiltfilt(butter(4, CUTOFF, fs=RATE, output="sos"), values, axis=0)


def _slope(x):
    before, after = (np.roll(x, k, axis=0) for k in (1, -1))
    two_before, two_after = (np.roll(x, k, axis=0) for k in (2, -2))
    return (two_before - 8 * before + 8 * after - two_after) * RATE / 12
