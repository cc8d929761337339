"""The format `graphdyn errata 1`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.paper.errata import Effect
from crosscheck.report.record_fields import FORMAT, Keywords, Number, Versions, taken
from crosscheck.report.versions import versions


@dataclass(frozen=True, kw_only=True)
class EffectRecord:
    """The distribution of one measured error over the samples."""

    erratum: Annotated[str, Keywords(pattern="^A[0-9]+$")]
    """Its number in docs/deviations.md."""

    robot: str
    """The robot it was measured on."""

    measure: str
    """What was measured, in words. Errors are relative and have no unit; ranks are counted in rows."""

    median: Number
    """Median of the printed form's error."""

    upper: Number
    """90 % quantile of the printed form's error."""

    largest: Number
    """Largest error of the printed form."""

    corrected: Number
    """Largest error of the corrected form."""


@dataclass(frozen=True, kw_only=True)
class ErrataRecord:
    """What the printed errors of the paper do, each put back alone into the correct model."""

    format: Annotated[Literal["graphdyn errata 1"], FORMAT] = "graphdyn errata 1"

    versions: Versions = field(default_factory=versions)

    effects: Sequence[EffectRecord]
    """One record per erratum, robot and, for A3, distance from gimbal lock."""


def effect_record(effect: Effect) -> EffectRecord:
    """One effect, as in the records of errata and paper."""
    return taken(EffectRecord, effect)


def record(effects: Sequence[Effect]) -> ErrataRecord:
    """What was measured."""
    return ErrataRecord(effects=[effect_record(effect) for effect in effects])
