"""Recordings larger than memory, read in windows, filtered and differentiated with overlap, as pieces of samples.

Every window overlaps its neighbors by the borders that the filter needs, so that the pieces follow each other without
a gap. They differ from those of the whole file by the remaining response of the filter there, BORDER_DECAY squared.
Rows that load_recording would drop or resample are refused by number.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from crosscheck.recordings.checks import Origin, stamp_findings, times, value_findings
from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.format import tables
from crosscheck.recordings.loading import reordered
from crosscheck.recordings.mapping.conversion import joint_channels, mapped_columns, sliding_joints
from crosscheck.recordings.mapping.mapping import ColumnMapping, given_mapping
from crosscheck.recordings.mapping.mapping_by_name import mapping_by_name
from crosscheck.recordings.preparation.derivatives import differentiated
from crosscheck.recordings.preparation.filtering import FORGETTING_BORDERS, samples_with, torque_filter
from crosscheck.recordings.preparation.resampling import PERIOD_TOLERANCE, refuse_delays
from crosscheck.recordings.recording import RECORDED_JOINT_CHANNELS, Provenance, Recording
from crosscheck.recordings.table import RecordedTable
from graphdyn import InvalidInput
from graphdyn.display import short_repr
from graphdyn.errors import counted
from graphdyn.identification import RowFilter, Samples


class RowPosition(NamedTuple):
    """Position of the first row of a table: its number in the log, and in its file, from 0."""

    in_log: int
    in_file: int


def window_of(
    table: RecordedTable, mapping: ColumnMapping, place: RowPosition, origin: Origin | None
) -> tuple[Recording, Origin | None]:
    """The rows at the joints in SI units, and the origin of their times, searched unless given.

    Raises InvalidInput for a row that is not a number, beyond a robot's reach, or whose time is not after that of the
    previous row.
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
    slides, file = sliding_joints(mapping, str(table.path)), str(table.path)
    of_values = value_findings(file, mapping.joints, slides, channels, None)
    of_stamps = stamp_findings(file, t, np.ones(len(t), dtype=bool), None, origin.seconds if origin else 0.0)
    for finding in (*of_values, *of_stamps):
        if finding.severity == "error":
            row = place.in_file + finding.rows[0]
            raise InvalidInput(f"{file}, row {row}: {finding.message}; {finding.remedy}")
    recording = Recording(
        joint_names=mapping.joints,
        t=t,
        prismatic=slides,
        provenance=Provenance((str(table.path),), mapping.source, (), mapping),
        **cast(Any, channels),
    )
    return recording, origin


def appended(recording: Recording, part: Recording) -> Recording:
    """Both windows in one block. Raises InvalidInput if the time goes back."""
    if not part.t[0] > recording.t[-1]:
        raise InvalidInput(f"{part.provenance.files[0]}: the time goes back to {part.t[0]:g} s; repair the file")
    names = recording.recorded(("t", *RECORDED_JOINT_CHANNELS))
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


ROWS_IN_MEMORY = 20_000
"""Default number of rows in memory at once: 4 MB for a six-axis arm."""


@dataclass(frozen=True)
@short_repr
class StreamedRecording:
    """A long recording for graphdyn.identification.Problem(data=…), read again by every iteration.

    path: Parquet, .csv or .csv.gz with a header
    mapping, joints, rate: as in load_recording; joints in the order of the robot, those of the mapping if left out
    cutoff: as in differentiated, [Hz] of all channels or per channel; None: no filter
    window: rows in memory at once

    There is no list of findings: rows that load_recording would drop or resample (NaN, what no robot reaches,
    uneven stamps) raise InvalidInput, with the row, or BadRecordingFile.
    """

    path: str | PathLike[str]
    mapping: ColumnMapping | str | PathLike[str] | None = None
    joints: Sequence[str] | None = None
    rate: float | None = None
    cutoff: float | Mapping[str, float] | None = None
    window: int = ROWS_IN_MEMORY

    def __iter__(self) -> Iterator[Samples]:
        """The pieces in order. Raises BadRecordingFile, BadMapping, InvalidInput, OSError."""
        whole: Recording | None = None
        row_filter: RowFilter | None = None
        first = 0
        for part in self._parts():
            whole = part if whole is None else appended(whole, part)
            if len(whole.t) >= self.window:
                done, border = self._differentiated(whole, first)
                overlap = 2 * FORGETTING_BORDERS * border
                if overlap >= len(whole.t):
                    raise InvalidInput(
                        f"a window of {counted(self.window, 'row')} is too short for the borders of the filter; "
                        f"give more than {overlap}, or a higher cutoff"
                    )
                inner = (FORGETTING_BORDERS - 1) * border
                row_filter = row_filter if first else torque_filter(done)
                begin = inner if first else 0
                yield samples_with(row_filter, done, slice(begin, len(done.t) - inner), continues=begin > 0)
                first += len(whole.t) - overlap
                whole = whole.take(slice(len(whole.t) - overlap, None))
        if whole is None:
            raise BadRecordingFile(f"{self.path}: no rows; record at least one")
        done, border = self._differentiated(whole, first)
        row_filter = row_filter if first else torque_filter(done)
        begin = (FORGETTING_BORDERS - 1) * border if first else 0
        yield samples_with(row_filter, done, slice(begin, None), continues=begin > 0)

    def _differentiated(self, recording: Recording, first: int) -> tuple[Recording, int]:
        """The window with v and a, and the numbers of rows cut at both of its ends. first: row of the file."""
        refuse_uneven(recording, self.path, first)
        done = differentiated(recording, self.cutoff)
        return done, int(np.searchsorted(recording.t, done.t[0]))

    def _parts(self) -> Iterator[Recording]:
        """Consecutive rows as read, at the joints in SI units."""
        path, count = Path(self.path), 0
        mapping = given_mapping(self.mapping, self.rate)
        origin: Origin | None = None
        for table in tables(path, mapping, self.window):
            if mapping is None:
                mapping = mapping_by_name(table, self.joints, self.rate)[0]
            refuse_delays(mapping)
            recording, origin = window_of(table, mapping, RowPosition(count, count), origin)
            count += len(table.values)
            yield recording if self.joints is None else reordered(recording, self.joints)
