"""Zero-phase low-pass filtering with a Butterworth filter, and decimation without aliasing.

For the identification, they are applied to the torque and every column of the regressor alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from math import ceil, log, prod
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crosscheck.recordings.preparation.resampling import sampling_rate
from crosscheck.recordings.recording import MOTION_CHANNELS, Recording
from graphdyn import InvalidInput
from graphdyn.errors import counted
from graphdyn.identification import RowFilter, Samples
from graphdyn.layout import Array

FILTER_ORDER = 4
"""Default order of the Butterworth filter, in one pass."""

REMEMBERED_FILTERS = 256
"""Filters whose sections are kept: the trial cutoffs of a channel are those of its other joints."""

BORDER_DECAY = 1e-3
"""Fraction of its initial value to which the slowest mode of the filter has decayed at the end of the border."""


def lowpass(values: Array, rate: float, cutoff: float, order: int = FILTER_ORDER) -> Array:
    """Values (N, …) sampled at the rate [Hz], filtered along the rows; N must exceed padding(order).

    cutoff [Hz], order: of one pass. The two passes together have zero phase and twice the attenuation, 6 dB at the
    cutoff (Gustafsson, Determining the initial states in forward-backward filtering, IEEE Trans. Signal Process. 1996).

    Raises InvalidInput for a cutoff outside 0 … rate/2, for an order below 1, for too few rows.
    """
    from scipy.signal import sosfiltfilt

    check_cutoff(rate, cutoff)
    if order < 1:
        raise InvalidInput(f"the order of the filter is {order}; choose 1 or more, usually 4")
    if len(values) <= padding(order):
        raise InvalidInput(
            f"{counted(len(values), 'row is', 'rows are')} too few for a filter of order {order}; "
            f"give more than {padding(order)}"
        )
    sections = butterworth(order, cutoff, rate)
    return np.asarray(sosfiltfilt(sections, values, axis=0, padlen=padding(order)))


@lru_cache(maxsize=REMEMBERED_FILTERS)
def butterworth(order: int, cutoff: float, rate: float) -> Array:
    """Second-order sections (k, 6) of a Butterworth low-pass, designed once. cutoff, rate [Hz]"""
    from scipy.signal import butter

    return np.asarray(butter(order, cutoff, fs=rate, output="sos"))


def check_cutoff(rate: float, cutoff: float) -> None:
    """Check a cutoff. Raises InvalidInput outside 0 … rate/2."""
    if not 0 < cutoff < rate / 2:
        raise InvalidInput(
            f"cutoff is {cutoff:g} Hz at {rate:g} samples per second; choose one between zero and {rate / 2:g} Hz"
        )


def padding(order: int = FILTER_ORDER) -> int:
    """Rows by which a block is extended on both sides: three times the filter's number of coefficients, as in SciPy."""
    return 3 * (order + 1)


def border(rate: float, cutoff: float, order: int = FILTER_ORDER) -> int:
    """Number of rows at each end that still depend on the extension of the data beyond it."""
    return int(np.ceil(settling_time(cutoff, BORDER_DECAY, order) * rate))


def settling_time(cutoff: float, left: float, order: int = FILTER_ORDER) -> float:
    """Time [s] in which the slowest mode of the filter decays to this fraction; the cutoff [Hz] may be infinite.

    The slowest pair of poles of a Butterworth filter decays at 2π cutoff sin(π / 2 order).
    """
    return float(-np.log(left) / (2 * np.pi * cutoff * np.sin(np.pi / (2 * order))))


MAX_STAGE_FACTOR = 13
"""Largest factor of a stage: beyond it the anti-aliasing filter is ill-conditioned (see scipy.signal.decimate)."""

PADDING_ROWS = 27
"""Rows by which scipy.signal.decimate extends the columns for its filter of order 8; a stage needs more rows."""


def decimated_columns(columns: ArrayLike, factors: Sequence[int]) -> Array:
    """Columns (N, …) of one uninterrupted block, decimated to (K, …): per stage, every f-th row from the first on.

    factors: f of each stage, 2 … 13: (10, 10) for a hundredth
    Each stage applies the zero-phase low-pass of scipy.signal.decimate: Chebyshev, order 8, 0.8 of the new Nyquist
    frequency.

    Raises InvalidInput for other factors and for too few rows.
    """
    from scipy.signal import sosfiltfilt

    if not factors or not all(isinstance(f, Integral) and 2 <= f <= MAX_STAGE_FACTOR for f in factors):
        raise InvalidInput(
            f"decimation by {tuple(factors)}; give factors from 2 to {MAX_STAGE_FACTOR}, larger ones in stages: "
            "(10, 10)"
        )
    values = np.asarray(columns, dtype=float)
    if len(values) < rows_needed(factors):
        raise InvalidInput(
            f"{counted(len(values), 'row is', 'rows are')} too few to be decimated by {tuple(factors)}; "
            f"give {rows_needed(factors)} or more"
        )
    for factor in factors:
        values = sosfiltfilt(_anti_aliasing(factor), values, axis=0)[::factor]
    return values


@cache
def _anti_aliasing(factor: int) -> Array:
    """Second-order sections of the filter of scipy.signal.decimate, designed once for all columns of a regressor."""
    from scipy.signal import cheby1

    return np.asarray(cheby1(8, 0.05, 0.8 / factor, output="sos"))


def slowest_pole(factor: int) -> float:
    """Largest modulus of the poles of the filter: from row to row its slowest mode decays by this factor."""
    from scipy.signal import sos2zpk

    return float(np.abs(sos2zpk(_anti_aliasing(factor))[1]).max())


def rows_needed(factors: Sequence[int]) -> int:
    """The fewest rows of a block that every stage can filter."""
    needed = PADDING_ROWS + 1
    for factor in reversed(factors[:-1]):
        needed = (needed - 1) * factor + 1
    return needed


FORGETTING_BORDERS = 2
"""Number of filter borders after which a row is forgotten: BORDER_DECAY squared is left."""

FORGOTTEN_SHARE = 1e-6
"""Remaining response after which a row is forgotten, for the filter of a decimation."""


@dataclass(frozen=True)
class TorqueFilter:
    """Zero-phase Butterworth low-pass of order 4, one pass, then decimation without aliasing.

    cutoff: infinite for no low-pass [Hz]; rate: of the samples [Hz]; factors: of the stages of the decimation, 2 … 13
    """

    cutoff: float = np.inf
    rate: float = 1.0
    factors: tuple[int, ...] = ()

    @property
    def factor(self) -> int:
        return prod(self.factors)

    @property
    def memory(self) -> int:
        rows = 0
        for factor in reversed(self.factors):
            rows = rows * factor + ceil(log(FORGOTTEN_SHARE) / log(slowest_pole(factor)))
        return rows + FORGETTING_BORDERS * border(self.rate, self.cutoff)

    def __call__(self, columns: Array) -> Array:
        if np.isfinite(self.cutoff):
            columns = lowpass(columns, self.rate, self.cutoff)
        return decimated_columns(columns, self.factors) if self.factors else columns


def samples_of(recording: Recording, decimate: tuple[int, ...] = ()) -> list[Samples]:
    """A recording with v and a for graphdyn.identification.Problem, block by block, with the filter of its torque.

    decimate: factors of the stages, 2 … 13, after the low-pass
    Blocks too short to be filtered are left out. Raises InvalidInput for a missing channel, and if none is left.
    """
    for name in ("v", "a", "tau"):
        recording.channel(name)
    blocks = [recording.take(rows) for rows in filtered_blocks(recording, decimate)]
    return [samples_with(torque_filter(block, decimate), block) for block in blocks]


def filtered_blocks(recording: Recording, decimate: tuple[int, ...] = ()) -> list[slice]:
    """The rows of the blocks that are long enough for the filter of their torque. Raises InvalidInput without one."""
    blocks, needed = [], 1
    for rows in recording.block_slices:
        needed = rows_needed(decimate) if decimate else 1
        if np.isfinite(recording.torque_cutoff[rows.start]):
            needed = max(needed, padding() + 1)
        if rows.stop - rows.start >= needed:
            blocks.append(rows)
    if not blocks:
        what = f"decimation by {decimate}" if decimate else "the filter"
        remedy = "use smaller factors, or hold out less" if decimate else "record longer, or hold out less"
        raise InvalidInput(
            f"{', '.join(recording.provenance.files)}: no block has the {needed} rows that {what} needs; {remedy}"
        )
    return blocks


def samples_with(
    row_filter: RowFilter | None, recording: Recording, rows: Any = slice(None), continues: bool = False
) -> Samples:
    """Rows of a recording with v and a as samples, with a filter; continues: whether others precede them."""
    q, v, a, tau = (recording.channel(name)[rows] for name in MOTION_CHANNELS)
    temperature = None if recording.temperature is None else recording.temperature[rows]
    return Samples(
        q, v, a, tau, row_filter=row_filter, continues=continues, time=recording.t[rows], temperature=temperature
    )


def torque_filter(block: Recording, decimate: tuple[int, ...] = ()) -> RowFilter | None:
    """The filter still to be applied to the torque of one block, and to every column of the regressor."""
    cutoff = float(block.torque_cutoff[0])
    if np.isfinite(cutoff):
        return TorqueFilter(cutoff, sampling_rate(block), decimate)
    return TorqueFilter(factors=decimate) if decimate else None
