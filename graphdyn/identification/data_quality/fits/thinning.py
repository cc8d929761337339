"""Evenly spaced rows of a recording, with the torque between its samples."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.identification.data.samples import Samples, joined_samples
from graphdyn.layout import Array

MAX_EXAMINED_ROWS = 600
"""Number of rows that are examined: few rows show a recording's faults, and each trial then costs milliseconds."""

MAX_LAG = 0.2
"""Longest delay in the search [s]; in a short recording it is MAX_LAG_SHARE of the longest piece."""
MAX_LAG_SHARE = 0.1

SPLINE_ORDER = 5
"""Order of the spline of the torque: below a fifth of the sampling rate it is exact to 1e-4."""


SMOOTHING_ORDER, MAX_CUTOFF_SHARE = 4, 0.4
"""Order of the low-pass, and the largest part of the sampling rate that its cutoff may be."""


class TooShort(InvalidInput):
    """A recording too short to look for delays."""


@dataclass(frozen=True, eq=False)
@short_repr
class Piece:
    """An uninterrupted piece of a recording, prepared: q, v, a and tau low-passed alike. period [s]."""

    samples: Samples
    period: float

    def derived(self) -> Piece:
        """The piece with v and a from the positions, which are low-passed."""
        from scipy.interpolate import make_interp_spline

        t = np.arange(len(self.samples)) * self.period
        spline = make_interp_spline(t, self.samples.q, k=SPLINE_ORDER)
        return replace(self, samples=replace(self.samples, v=spline(t, 1), a=spline(t, 2)))

    def later(self, seconds: Array) -> Piece:
        """The piece with the torque measured so much later, a time for each joint (n,); at the end the last one."""
        from scipy.interpolate import make_interp_spline

        t = np.arange(len(self.samples)) * self.period
        spline = make_interp_spline(t, self.samples.tau, k=SPLINE_ORDER)
        shifted = [spline(np.clip(t + x, 0.0, t[-1]))[:, j] for j, x in enumerate(seconds)]
        return replace(self, samples=replace(self.samples, tau=np.column_stack(shifted)))


class ThinnedRecording:
    """Rows far enough from both ends of their piece that the torque may be shifted by `span` seconds."""

    def __init__(self, pieces: Sequence[Piece], rows: int = MAX_EXAMINED_ROWS):
        from scipy.interpolate import BSpline, make_interp_spline

        self._pieces, self._rows = pieces, rows
        longest = max(len(piece.samples) * piece.period for piece in pieces)
        self.span = min(MAX_LAG, MAX_LAG_SHARE * longest)
        margins = [int(np.ceil(self.span / piece.period)) for piece in pieces]
        usable = [
            (piece, margin)
            for piece, margin in zip(pieces, margins, strict=True)
            if len(piece.samples) > 2 * margin + SPLINE_ORDER + 1
        ]
        every = max(1, sum(len(piece.samples) - 2 * margin for piece, margin in usable) // rows)
        self._parts = []
        kept: list[Samples] = []
        for piece, margin in usable:
            chosen = slice(margin, len(piece.samples) - margin, every)
            t = np.arange(len(piece.samples)) * piece.period
            spline = make_interp_spline(t, piece.samples.tau, k=SPLINE_ORDER)
            each = [BSpline(spline.t, column, SPLINE_ORDER) for column in spline.c.T]
            self._parts.append((spline, each, t[chosen]))
            kept.append(piece.samples[chosen])
        if not kept:
            raise TooShort("no piece of the recording is long enough to look for delays; record longer")
        if kept[0].base is not None:
            raise InvalidInput(
                "the base of the robot moves; the data quality of a recording is known for a base at rest only"
            )
        self.samples = joined_samples(kept, slice(None))

    def torque(self, later: float | Array = 0.0) -> Array:
        """The torque measured so much later (N, n), one time for all joints or one for each (n,) [s]."""
        if not isinstance(later, np.ndarray):
            return np.concatenate([spline(t + later) for spline, _, t in self._parts])
        return np.column_stack([self.torque_of(j, x) for j, x in enumerate(later)])

    def torque_of(self, joint: int, later: float) -> Array:
        """The torque of one joint measured so much later (N,)."""
        return np.concatenate([each[joint](t + later) for _, each, t in self._parts])

    def torque_rate(self, later: Array) -> Array:
        """Rate of the torque measured so much later, a time for each joint (n,): (N, n) [N m/s or N/s]."""
        columns = [np.concatenate([each[j](t + x, 1) for _, each, t in self._parts]) for j, x in enumerate(later)]
        return np.column_stack(columns)

    def smoothed(self, cutoff: float) -> ThinnedRecording:
        """The recording after a zero-phase low-pass [Hz] of q, v, a and tau alike, in the same rows.

        Itself, where the cutoff is above MAX_CUTOFF_SHARE of the sampling rate.
        """
        from scipy.signal import butter, sosfiltfilt

        if cutoff > MAX_CUTOFF_SHARE / max(piece.period for piece in self._pieces):
            return self
        pieces = []
        for piece in self._pieces:
            sections = butter(SMOOTHING_ORDER, cutoff, fs=1 / piece.period, output="sos")
            past = min(len(piece.samples) - 1, int(np.ceil(1 / (cutoff * piece.period))))
            low = {
                name: sosfiltfilt(sections, getattr(piece.samples, name), axis=0, padlen=past)
                for name in ("q", "v", "a", "tau")
            }
            pieces.append(replace(piece, samples=replace(piece.samples, **low)))
        return ThinnedRecording(pieces, self._rows)
