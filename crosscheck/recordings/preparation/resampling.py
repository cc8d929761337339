"""Resampling to even steps inside each block, and correction of delayed torques."""

from __future__ import annotations

import numpy as np

from crosscheck.recordings.errors import BadMapping
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.recording import OPTIONAL_CHANNELS, RECORDED_JOINT_CHANNELS, Recording
from graphdyn import InvalidInput

PERIOD_TOLERANCE = 1e-3
"""Relative difference of steps up to which there is no resampling: the relative error of a difference quotient."""

MIN_SPLINE_ROWS = 4
"""Smallest number of rows for a cubic spline."""


def sampling_rate(recording: Recording) -> float:
    """Samples per second: the reciprocal of the median step inside the blocks. Raises InvalidInput for single rows."""
    steps = np.diff(recording.t)[np.diff(recording.block) == 0]
    if not steps.size:
        raise InvalidInput("every block of the recording is one row; a sampling rate needs two")
    return float(1 / np.median(steps))


def is_even(recording: Recording) -> bool:
    """Whether all steps inside the blocks are the same."""
    steps = np.diff(recording.t)[np.diff(recording.block) == 0]
    return bool(steps.size == 0 or np.all(np.abs(steps * sampling_rate(recording) - 1) <= PERIOD_TOLERANCE))


def resampled(recording: Recording, rate: float | None = None) -> Recording:
    """The recording at even steps, by a cubic spline inside each block; rate [Hz]: the recording's own unless given.

    Blocks of fewer than 4 rows are left out, which its provenance states. Raises InvalidInput for a lower rate, which
    would alias high frequencies, and if no block is left.
    """
    from scipy.interpolate import CubicSpline

    own = sampling_rate(recording)
    rate = own if rate is None else rate
    if not (np.isfinite(rate) and rate >= own * (1 - PERIOD_TOLERANCE)):
        raise InvalidInput(f"rate is {rate:g} Hz, the recording has {own:g} Hz; a lower one would alias")
    names = recording.recorded(("t", *RECORDED_JOINT_CHANNELS, *OPTIONAL_CHANNELS))
    parts: dict[str, list[np.ndarray]] = {name: [] for name in (*names, "nearest")}
    short = []
    for rows in recording.block_slices:
        t = recording.t[rows]
        if len(t) < MIN_SPLINE_ROWS:
            short.append(int(recording.block[rows][0]))
            continue
        even = t[0] + np.arange(int((t[-1] - t[0]) * rate * (1 + 1e-9)) + 1) / rate
        even = np.minimum(even, t[-1])  # against extrapolation by rounding
        for name in names:
            parts[name].append(even if name == "t" else CubicSpline(t, getattr(recording, name)[rows], axis=0)(even))
        middles = (t[1:] + t[:-1]) / 2
        parts["nearest"].append(rows.start + np.searchsorted(middles, even))
    if not parts["t"]:
        raise InvalidInput(f"no block of the recording has {MIN_SPLINE_ROWS} rows; nothing can be resampled")
    step = f"resampled to {rate:.6g} Hz by cubic splines"
    if short:
        step += f", without the blocks {', '.join(map(str, short))} of fewer than {MIN_SPLINE_ROWS} rows"
    joined = {name: np.concatenate(part) for name, part in parts.items()}
    return recording.take(joined.pop("nearest"), step, **joined)


def with_delays_undone(recording: Recording, mapping: ColumnMapping) -> Recording:
    """The recording with τ(t + delay) at t, by cubic splines inside each block; rows without a torque are then cut.

    The joints are in the order of the mapping. Raises BadMapping if no row is left.
    """
    from scipy.interpolate import CubicSpline

    channel = mapping.channels.get("tau")
    if channel is None or not channel.delays.any() or recording.tau is None:
        return recording
    delays, kept, torques = channel.delays, [], []
    for rows in recording.block_slices:
        t = recording.t[rows]
        inside = (t + delays.min() >= t[0]) & (t + delays.max() <= t[-1])
        if len(t) >= MIN_SPLINE_ROWS and inside.any():
            kept.append(rows.start + np.flatnonzero(inside))
            spline = CubicSpline(t, recording.tau[rows], axis=0)
            torques.append(np.column_stack([spline(t[inside] + delay)[:, j] for j, delay in enumerate(delays)]))
    if not kept:
        longest = np.abs(delays).max()
        raise BadMapping(f"{mapping.source}, [tau]: a delay of {longest:g} s leaves no row; it is in seconds")
    words = ", ".join(f"{1e3 * seconds:g}" for seconds in (delays if np.ptp(delays) else delays[:1]))
    return recording.take(np.concatenate(kept), f"torques {words} ms earlier", tau=np.concatenate(torques))


def refuse_delays(mapping: ColumnMapping) -> None:
    """Raise BadMapping for a mapping with delays, for a recording that is read window by window."""
    channel = mapping.channels.get("tau")
    if channel is not None and channel.delays.any():
        raise BadMapping(
            f"{mapping.source}, [tau]: delay is not possible for a recording that is streamed; shift the column itself"
        )
