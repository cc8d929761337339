"""The format `graphdyn paper 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.records._fields import FORMAT, Command, Count, Number, Versions, taken
from crosscheck.report.records.errata import EffectRecord, effect_record
from crosscheck.report.records.paper_identification import PaperIdentificationRecord, paper_identification_record
from crosscheck.report.records.paper_multipliers import (
    AsPrintedRecord,
    CorrectedRecord,
    as_printed_record,
    corrected_record,
)
from crosscheck.report.records.paper_printed import SIX
from crosscheck.report.versions import versions
from crosscheck.studies.errata import ERRATA
from crosscheck.studies.paper.reproduction import Reproduction
from crosscheck.studies.paper.tables import WHY_TABLE_2


@dataclass(frozen=True, kw_only=True)
class CheckRecord:
    """One check."""

    where: str
    """Table, equation or section."""

    what: str
    """What was measured, in words, with its unit unless it has none."""

    measured: Number
    """Its value; null where it is no number."""

    bound: float
    """What it must not exceed, or not fall below."""

    why: str
    """Why this bound."""

    at_least: bool
    """The bound is a lower one."""

    agrees: bool
    """The measured value is within the bound."""


@dataclass(frozen=True, kw_only=True)
class RowRecord:
    """A row of Table 2."""

    name: str
    """Row, with its unit."""

    printed: Annotated[Sequence[str], SIX]
    """As printed."""

    ours: Annotated[Sequence[float], SIX]
    """Not rounded: lengths and radii as given, the rest from density and geometry [m, kg, kg m²]."""


@dataclass(frozen=True, kw_only=True)
class Table2:
    """Geometry, masses and moments of inertia."""

    why: str
    """Why numbers differ, or that they do not."""

    rows: Annotated[Sequence[RowRecord], SIX]
    """The six rows of Table 2."""


@dataclass(frozen=True, kw_only=True)
class RankRecord:
    """The rank at one time."""

    time: float
    """Time [s]."""

    rank: Count
    """Rank of the 30 printed rows."""


@dataclass(frozen=True, kw_only=True)
class OverTimeRecord:
    """The whole motion of section 3.1."""

    samples: Count
    """Number of times."""

    difference: Number
    """Of multipliers, forces, moments and torques from those of rnea, relative to the largest of their kind."""

    ranks: Sequence[RankRecord]
    """When the printed rows have which rank."""


@dataclass(frozen=True, kw_only=True)
class PaperErrataRecord:
    """What the printed errors do, as in graphdyn errata --json."""

    samples: Count
    """Random states per robot."""

    seed: Count
    """Of the random states."""

    sentences: Mapping[str, str]
    """What each erratum is, by its number."""

    effects: Sequence[EffectRecord]
    """One record per erratum, robot and, for A3, distance from gimbal lock."""


@dataclass(frozen=True, kw_only=True)
class PaperRecord:
    """Every table and result of the paper beside the corrected model. Columns are bodies or joints 1 … 6."""

    format: Annotated[Literal["graphdyn paper 1"], FORMAT] = "graphdyn paper 1"

    versions: Versions = field(default_factory=versions)

    command: Command

    agrees: bool
    """Every check holds."""

    checks: Sequence[CheckRecord]
    """What must hold, in the order of the paper."""

    table_2: Table2
    """Geometry, masses and moments of inertia."""

    identification: PaperIdentificationRecord
    """Tables 3 and 4."""

    as_printed: AsPrintedRecord
    """Section 3.2 from the printed rows."""

    corrected: CorrectedRecord
    """Section 3.2 from the corrected model, at 1.5 s."""

    over_time: OverTimeRecord
    """The whole motion of section 3.1."""

    errata: PaperErrataRecord
    """What the printed errors do, as in graphdyn errata --json."""


def record(found: Reproduction, command: Sequence[str]) -> PaperRecord:
    """Everything but the curves of the pictures."""
    return PaperRecord(
        command=command,
        agrees=found.agrees,
        checks=[taken(CheckRecord, check) for check in found.checks],
        table_2=Table2(
            why=WHY_TABLE_2,
            rows=[
                RowRecord(name=name, printed=[str(number.text) for number in printed], ours=ours.tolist())
                for name, printed, ours in zip(
                    found.geometry.rows, found.geometry.printed, found.geometry.ours, strict=True
                )
            ],
        ),
        identification=paper_identification_record(found.identification),
        as_printed=as_printed_record(found),
        corrected=corrected_record(found),
        over_time=OverTimeRecord(
            samples=len(found.over_time.recording.time),
            difference=found.over_time.difference,
            ranks=[RankRecord(time=time, rank=rank) for time, rank in found.over_time.ranks.items()],
        ),
        errata=PaperErrataRecord(
            samples=found.samples,
            seed=found.seed,
            sentences=ERRATA,
            effects=[effect_record(effect) for effect in found.effects],
        ),
    )
