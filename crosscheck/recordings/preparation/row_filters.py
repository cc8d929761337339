"""Filters of a recording for the identification: applied to the torque and every column of the regressor alike."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log, prod

import numpy as np

from crosscheck.recordings.preparation.filtering import (
    border,
    decimated_columns,
    lowpass,
    padding,
    rows_needed,
    slowest_pole,
)
from crosscheck.recordings.preparation.resampling import sampling_rate
from crosscheck.recordings.recording import Recording
from graphdyn import InvalidInput
from graphdyn.identification import RowFilter, Samples
from graphdyn.layout import Array

FORGETTING_BORDERS = 2
"""Number of filter borders after which a row is forgotten: BORDER_DECAY squared is left."""

FORGOTTEN_SHARE = 1e-6
"""Remaining response after which a row is forgotten, for the filter of a decimation."""


@dataclass(frozen=True)
class LowPass:
    """Zero-phase Butterworth low-pass of order 4, one pass; cutoff, sampling rate [Hz]."""

    cutoff: float
    rate: float

    @property
    def factor(self) -> int:
        return 1

    @property
    def memory(self) -> int:
        return FORGETTING_BORDERS * border(self.rate, self.cutoff)

    def __call__(self, columns: Array) -> Array:
        return lowpass(columns, self.rate, self.cutoff)


@dataclass(frozen=True)
class Decimation:
    """Decimation without aliasing; factors: of the stages, 2 … 13."""

    factors: tuple[int, ...]

    @property
    def factor(self) -> int:
        return prod(self.factors)

    @property
    def memory(self) -> int:
        rows = 0
        for factor in reversed(self.factors):
            rows = rows * factor + ceil(log(FORGOTTEN_SHARE) / log(slowest_pole(factor)))
        return rows

    def __call__(self, columns: Array) -> Array:
        return decimated_columns(columns, self.factors)


@dataclass(frozen=True)
class LowPassAndDecimation:
    """Low-pass, then decimation."""

    lowpass: LowPass
    decimation: Decimation

    @property
    def factor(self) -> int:
        return self.decimation.factor

    @property
    def memory(self) -> int:
        return self.lowpass.memory + self.decimation.memory

    def __call__(self, columns: Array) -> Array:
        return self.decimation(self.lowpass(columns))


def samples_of(recording: Recording, decimate: tuple[int, ...] = ()) -> list[Samples]:
    """A recording with v and a for graphdyn.identification.Problem, block by block, with the filter of its torque.

    decimate: factors of the stages, 2 … 13, after the low-pass
    Blocks too short to be filtered are left out. Raises InvalidInput for a missing channel, and if none is left.
    """
    for name in ("v", "a", "tau"):
        recording.channel(name)
    return [_samples(recording.take(rows), decimate) for rows in filtered_blocks(recording, decimate)]


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


def _samples(block: Recording, decimate: tuple[int, ...]) -> Samples:
    q, v, a, tau = (block.channel(name) for name in ("q", "v", "a", "tau"))
    return Samples(q, v, a, tau, row_filter=torque_filter(block, decimate), time=block.t, temperature=block.temperature)


def torque_filter(block: Recording, decimate: tuple[int, ...] = ()) -> RowFilter | None:
    """The filter still to be applied to the torque of one block, and to every column of the regressor."""
    cutoff = float(block.torque_cutoff[0])
    decimation = Decimation(decimate) if decimate else None
    if not np.isfinite(cutoff):
        return decimation
    lowpass = LowPass(cutoff, sampling_rate(block))
    return lowpass if decimation is None else LowPassAndDecimation(lowpass, decimation)
