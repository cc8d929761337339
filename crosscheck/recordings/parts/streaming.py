"""Recordings larger than memory, read in windows, filtered and differentiated with overlap, as pieces of samples.

Every window overlaps its neighbors by the borders that the filter needs, so that the pieces follow each other without
a gap. They differ from those of the whole file by the remaining response of the filter there, BORDER_DECAY squared.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path

import numpy as np

from crosscheck.recordings.checks.clock import Origin
from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.table import tables
from crosscheck.recordings.loading import check_rate, reordered
from crosscheck.recordings.mapping.mapping import ColumnMapping, load_mapping
from crosscheck.recordings.mapping.mapping_by_name import mapping_by_name
from crosscheck.recordings.parts.windows import RowPosition, appended, refuse_uneven, window_of
from crosscheck.recordings.preparation.derivatives import differentiated
from crosscheck.recordings.preparation.resampling import refuse_delays
from crosscheck.recordings.preparation.row_filters import FORGETTING_BORDERS, torque_filter
from crosscheck.recordings.recording import Recording
from graphdyn import InvalidInput
from graphdyn.identification import RowFilter, Samples

ROWS_IN_MEMORY = 20_000
"""Default number of rows in memory at once: 4 MB for a six-axis arm."""


@dataclass(frozen=True)
class StreamedRecording:
    """A long recording for graphdyn.identification.Problem(data=…), read again by every iteration.

    path: Parquet, .csv or .csv.gz with a header
    mapping, joints, rate: as in load_recording; joints in the order of the robot, those of the mapping if left out
    cutoff: as in differentiated, [Hz] of all channels or per channel; None: no filter
    window: rows in memory at once

    There is no list of findings: rows that load_recording would drop or resample (NaN, uneven stamps) raise
    InvalidInput, with the row, or BadRecordingFile.
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
                        f"a window of {self.window} rows is too short for the borders of the filter; give more than "
                        f"{overlap}, or a higher cutoff"
                    )
                inner = (FORGETTING_BORDERS - 1) * border
                row_filter = row_filter if first else torque_filter(done)
                yield _samples(done, row_filter, inner if first else 0, inner)
                first += len(whole.t) - overlap
                whole = whole.take(slice(len(whole.t) - overlap, None))
        if whole is None:
            raise BadRecordingFile(f"{self.path}: no rows; record at least one")
        done, border = self._differentiated(whole, first)
        row_filter = row_filter if first else torque_filter(done)
        yield _samples(done, row_filter, (FORGETTING_BORDERS - 1) * border if first else 0, 0)

    def _differentiated(self, recording: Recording, first: int) -> tuple[Recording, int]:
        """The window with v and a, and the numbers of rows cut at both of its ends. first: row of the file."""
        refuse_uneven(recording, self.path, first)
        done = differentiated(recording, self.cutoff)
        return done, int(np.searchsorted(recording.t, done.t[0]))

    def _parts(self) -> Iterator[Recording]:
        """Consecutive rows as read, at the joints in SI units."""
        check_rate(self.rate)
        path, count = Path(self.path), 0
        mapping = None if self.mapping is None else self._mapping()
        origin: Origin | None = None
        for table in tables(path, mapping.delimiter if mapping else None, self.window):
            if mapping is None:
                mapping = mapping_by_name(table, self.joints, self.rate)[0]
            refuse_delays(mapping)
            recording, origin = window_of(table, mapping, RowPosition(count, count), origin)
            count += len(table.values)
            yield recording if self.joints is None else reordered(recording, self.joints)

    def _mapping(self) -> ColumnMapping:
        mapping = self.mapping if isinstance(self.mapping, ColumnMapping) else load_mapping(self.mapping)  # type: ignore[arg-type]
        return mapping if self.rate is None else replace(mapping, rate=self.rate)


def _samples(done: Recording, row_filter: RowFilter | None, before: int, after: int) -> Samples:
    """The recording without these numbers of rows at its beginning and end; if no rows precede it, it is the first."""
    own = slice(before, len(done.t) - after)
    q, v, a, tau = (done.channel(name)[own] for name in ("q", "v", "a", "tau"))
    temperature = None if done.temperature is None else done.temperature[own]
    return Samples(q, v, a, tau, row_filter=row_filter, continues=before > 0, time=done.t[own], temperature=temperature)
