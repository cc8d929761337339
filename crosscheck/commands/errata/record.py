"""The format `graphdyn errata 1`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

from crosscheck.paper.errata import Effect
from crosscheck.report.records.record import Keywords, Number, Record, Versions, attribute, written


class EffectRecord(Record, of=Effect, leave_out=("errors", "corrected_errors", "cosine")):
    """The distribution of one measured error over the samples."""

    erratum: Annotated[str, Keywords(pattern="^A[0-9]+$")]
    median: Number = attribute()
    upper: Number = attribute()
    largest: Number = attribute()
    corrected: Number = attribute()


class ErrataRecord(Record, format="graphdyn errata 1"):
    """What the printed errors of the paper do, each put back alone into the correct model.

    effects: one record per erratum, robot and, for A3, distance from gimbal lock
    """

    versions: Versions
    effects: Sequence[EffectRecord]


def record(effects: Sequence[Effect]) -> dict[str, Any]:
    """What was measured."""
    return written(ErrataRecord, effects=effects)
