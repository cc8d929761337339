"""The format `graphdyn recording 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from crosscheck.recordings import RecognizedLog
from crosscheck.recordings.recognizing.recognized import OpenChoice, RecognizedBlock, RecognizedClock
from crosscheck.report.records.record import CommandRecord, Count, Number, Record, attribute, written


class RecognizedClockRecord(Record, of=RecognizedClock, leave_out=("values",)):
    """A column of time."""


class RecognizedBlockRecord(Record, of=RecognizedBlock, leave_out=("values",)):
    """Columns of one quantity."""


class OpenChoiceRecord(Record, of=OpenChoice):
    """What the log does not tell."""


class RecognitionRecord(CommandRecord, of=RecognizedLog, format="graphdyn recording 1"):
    """What the columns of a log are.

    complete: the mapping can be used as it is
    """

    complete: bool = attribute()
    rows: Count
    rate: Number
    clocks: Sequence[RecognizedClockRecord]
    blocks: Sequence[RecognizedBlockRecord]
    others: Mapping[str, str]
    open: Sequence[OpenChoiceRecord]


def record(found: RecognizedLog, command: Sequence[str]) -> dict[str, Any]:
    """All of it but the numbers of the columns."""
    return written(RecognitionRecord, found, command=command)
