"""Consecutive rows of a long log as a recording; rows that load_recording would drop or resample are refused by
number.
"""

from __future__ import annotations

from typing import Any, NamedTuple, cast

import numpy as np

from crosscheck.recordings.checks.clock import Origin, times
from crosscheck.recordings.mapping.conversion import joint_channels, mapped_columns, sliding_joints
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.preparation.resampling import PERIOD_TOLERANCE
from crosscheck.recordings.recording import RECORDED_JOINT_CHANNELS, Provenance, Recording
from crosscheck.recordings.table import RecordedTable
from graphdyn import InvalidInput


class RowPosition(NamedTuple):
    """Position of the first row of a table: its number in the log, and in its file, from 0."""

    in_log: int
    in_file: int


def window_of(
    table: RecordedTable, mapping: ColumnMapping, place: RowPosition, origin: Origin | None
) -> tuple[Recording, Origin | None]:
    """The rows at the joints in SI units, and the origin of their times, searched unless given.

    Raises InvalidInput for a row that is not a number, or whose time is not after that of the previous row.
    """
    columns = mapped_columns([table], mapping)
    if mapping.time:
        t, origin = times(columns["time"], mapping.time.factor, origin)
    else:
        t = np.arange(place.in_log, place.in_log + len(table.values)) / (mapping.rate or 1.0)
    channels = joint_channels(columns, mapping)
    bad = np.flatnonzero(~np.isfinite(np.column_stack([t, *channels.values()])).all(axis=1))
    back = np.flatnonzero(np.diff(t) <= 0)
    for found, what in ((bad, "not a number"), (back, "the time does not increase after it")):
        if found.size:
            raise InvalidInput(
                f"{table.path}, row {place.in_file + found[0]}: {what}; load_recording drops such rows, for which the "
                "file has to fit into memory"
            )
    recording = Recording(
        joint_names=mapping.joints,
        t=t,
        prismatic=sliding_joints(mapping),
        provenance=Provenance((str(table.path),), mapping.source, (), mapping),
        **cast(Any, channels),
    )
    return recording, origin


def appended(recording: Recording, part: Recording) -> Recording:
    """Both windows in one block. Raises InvalidInput if the time goes back."""
    if not part.t[0] > recording.t[-1]:
        raise InvalidInput(f"{part.provenance.files[0]}: the time goes back to {part.t[0]:g} s; repair the file")
    names = [name for name in ("t", *RECORDED_JOINT_CHANNELS) if getattr(recording, name) is not None]
    joined: dict[str, Any] = {name: np.concatenate([getattr(recording, name), getattr(part, name)]) for name in names}
    return Recording(recording.joint_names, **joined, prismatic=recording.prismatic, provenance=recording.provenance)


def refuse_uneven(recording: Recording, where: object, first: int) -> None:
    """Raise InvalidInput for a recording that would have to be resampled. first: row of the log."""
    steps = np.diff(recording.t)
    uneven = np.flatnonzero(np.abs(steps - np.median(steps)) > PERIOD_TOLERANCE * np.median(steps))
    if uneven.size:
        raise InvalidInput(
            f"{where}: after row {first + uneven[0]} the time steps by {steps[uneven[0]]:g} s instead of "
            f"{np.median(steps):g} s; load_recording divides or resamples such a file, which has to fit into memory"
        )
