"""Zero-phase low-pass filtering: a Butterworth filter run forward and backward."""

from __future__ import annotations

import numpy as np

from graphdyn import InvalidInput
from graphdyn.layout import Array

ORDER = 4
"""Of the Butterworth filter unless told otherwise, one pass."""

BORDER_DECAY = 1e-3
"""Part of its initial value to which the slowest mode of the filter has decayed at the end of the border."""


def lowpass(values: Array, rate: float, cutoff: float, order: int = ORDER) -> Array:
    """Values (N, …) sampled at the rate [Hz], filtered along the rows; N must exceed padding(order).

    cutoff [Hz], order: of one pass. The two passes together have zero phase and twice the attenuation, 6 dB at the
    cutoff (Gustafsson, Determining the initial states in forward-backward filtering, IEEE Trans. Signal Process. 1996).

    Raises InvalidInput for a cutoff outside 0 … rate/2, for an order below 1, for too few rows.
    """
    from scipy.signal import butter, sosfiltfilt

    check_cutoff(rate, cutoff)
    if order < 1:
        raise InvalidInput(f"the order of the filter is {order}; choose 1 or more, usually 4")
    if len(values) <= padding(order):
        raise InvalidInput(
            f"{len(values)} rows are too few for a filter of order {order}; give more than {padding(order)}"
        )
    sections = butter(order, cutoff, fs=rate, output="sos")
    return np.asarray(sosfiltfilt(sections, values, axis=0, padlen=padding(order)))


def check_cutoff(rate: float, cutoff: float) -> None:
    """Raises InvalidInput for a cutoff outside 0 … rate/2."""
    if not 0 < cutoff < rate / 2:
        raise InvalidInput(
            f"cutoff is {cutoff:g} Hz at {rate:g} samples per second; choose one between zero and {rate / 2:g} Hz"
        )


def padding(order: int = ORDER) -> int:
    """Rows by which a block is extended on both sides: three times the filter's number of coefficients, as in SciPy."""
    return 3 * (order + 1)


def border(rate: float, cutoff: float, order: int = ORDER) -> int:
    """Number of rows at each end that still depend on how the data were extended beyond it."""
    return int(np.ceil(settling_time(cutoff, BORDER_DECAY, order) * rate))


def settling_time(cutoff: float, left: float, order: int = ORDER) -> float:
    """Time [s] in which the slowest mode of the filter decays to this part; the cutoff [Hz] may be infinite.

    The slowest pair of poles of a Butterworth filter decays at 2π cutoff sin(π / 2 order).
    """
    return float(-np.log(left) / (2 * np.pi * cutoff * np.sin(np.pi / (2 * order))))
