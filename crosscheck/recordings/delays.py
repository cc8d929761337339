"""Torques that were recorded late, brought back to the instant of the motion."""

from __future__ import annotations

import numpy as np

from crosscheck.recordings.errors import BadMapping
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.recording import Recording
from graphdyn.layout import Array

SHORTEST = 4
"""Smallest number of rows for a cubic spline."""


def with_delays_undone(recording: Recording, mapping: ColumnMapping) -> Recording:
    """The recording with τ(t + delay) at t, by cubic splines inside each block; rows without a torque then are cut.

    The joints are in the order of the mapping. Raises BadMapping where no row is left.
    """
    channel = mapping.channels.get("tau")
    if channel is None or not channel.delays.any() or recording.tau is None:
        return recording
    delays, kept, torques = channel.delays, [], []
    for rows in recording.block_slices:
        t = recording.t[rows]
        inside = (t + delays.min() >= t[0]) & (t + delays.max() <= t[-1])
        if len(t) >= SHORTEST and inside.any():
            kept.append(rows.start + np.flatnonzero(inside))
            torques.append(_shifted(t, recording.tau[rows], delays)[inside])
    if not kept:
        longest = np.abs(delays).max()
        raise BadMapping(f"{mapping.source}, [tau]: a delay of {longest:g} s leaves no row; it is in seconds")
    words = ", ".join(f"{1e3 * seconds:g}" for seconds in (delays if np.ptp(delays) else delays[:1]))
    return recording.take(np.concatenate(kept), f"torques {words} ms earlier", tau=np.concatenate(torques))


def _shifted(t: Array, tau: Array, delays: Array) -> Array:
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(t, tau, axis=0)
    return np.column_stack([spline(t + seconds)[:, j] for j, seconds in enumerate(delays)])


def refuse_delays(mapping: ColumnMapping) -> None:
    """Raise BadMapping for a mapping with delays, where a recording is read window by window."""
    channel = mapping.channels.get("tau")
    if channel is not None and channel.delays.any():
        raise BadMapping(
            f"{mapping.source}, [tau]: delay is not possible for a recording that is streamed; shift the column itself"
        )
