"""The format `graphdyn recording 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from crosscheck.recordings import RecognizedLog
from crosscheck.recordings.recognizing.recognized import Block, Clock, OpenChoice
from crosscheck.report.records.record import CommandRecord, Count, Number, Record, attribute, written


class ClockRecord(Record, of=Clock, leave_out=("values",)):
    """A column of time."""


class BlockRecord(Record, of=Block, leave_out=("values",)):
    """Columns of one quantity."""


class ChoiceRecord(Record, of=OpenChoice):
    """What the log does not tell."""


class RecordingRecord(CommandRecord, of=RecognizedLog, format="graphdyn recording 1"):
    """What the columns of a log are.

    complete: the mapping can be used as it is
    """

    complete: bool = attribute()
    rows: Count
    rate: Number
    clocks: Sequence[ClockRecord]
    blocks: Sequence[BlockRecord]
    others: Mapping[str, str]
    open: Sequence[ChoiceRecord]


def record(found: RecognizedLog, command: Sequence[str]) -> dict[str, Any]:
    """All of it but the numbers of the columns."""
    return written(RecordingRecord, found, command=command)
