"""A printed number in `graphdyn paper 1`, and what its tables have in common.

What `graphdyn paper 1` says of Tables 3 and 4: the identified parameters.

What `graphdyn paper 1` says of section 3.2, the multipliers: from the printed rows, and from the corrected model.

The format `graphdyn paper 1`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np

from crosscheck.commands.errata.record import EffectRecord, effect_record
from crosscheck.paper.checks import WHY_CORRECTED
from crosscheck.paper.errata import ERRATA
from crosscheck.paper.identification import WHY_TABLE_3, PaperIdentification, PaperTrial
from crosscheck.paper.multipliers import KINDS, WHY_PRINTED, printed_ratios
from crosscheck.paper.printed import PARAMETERS, TABLE_3, TABLE_4, Printed
from crosscheck.paper.reproduction import Reproduction
from crosscheck.paper.tables import WHY_TABLE_2
from crosscheck.report.record_fields import FORMAT, Command, Count, Keywords, Number, Vector3, Versions, taken
from crosscheck.report.versions import versions
from graphdyn.layout import Array

SIX = Keywords(minItems=6, maxItems=6)
"""One entry per body or joint."""


@dataclass(frozen=True, kw_only=True)
class PrintedNumberRecord:
    """One printed number."""

    printed: str | None
    """As printed, digit by digit; null where the paper prints a dash."""

    reading: str | None
    """What a misprint should read."""

    erratum: str | None
    """Number of the misprint in docs/deviations.md."""


def printed_number_record(number: Printed) -> PrintedNumberRecord:
    return PrintedNumberRecord(printed=number.text, reading=number.reading, erratum=number.erratum or None)


NAMES = Keywords(required=list(PARAMETERS))
ByParameter = Annotated[Mapping[str, Annotated[Sequence[Number], SIX]], NAMES]
PrintedByParameter = Annotated[Mapping[str, Annotated[Sequence[PrintedNumberRecord], SIX]], NAMES]


@dataclass(frozen=True, kw_only=True)
class TrialRecord:
    """One identification."""

    data: str
    """Which data."""

    values: ByParameter
    """Identified [kg, kg m²]; null where the data do not determine it."""

    errors: ByParameter
    """Values minus true ones [kg, kg m²]."""

    standard_deviations: ByParameter
    """As the residual shows them [kg, kg m²]; null where nothing does."""

    undetermined: Sequence[str]
    """Names of the parameters that the data do not determine."""

    rank: Count
    """Of 36 columns."""

    condition_number: float
    """The worst of the systems, on what they determine."""

    largest: float
    """Largest absolute error over the compared entries [kg, kg m²]."""

    rms: float
    """Root mean square of these errors [kg, kg m²]."""


@dataclass(frozen=True, kw_only=True)
class PaperIdentificationRecord:
    """Tables 3 and 4."""

    why: str
    """Why numbers differ."""

    true: ByParameter
    """From density and geometry [kg, kg m²]."""

    table_3: PrintedByParameter
    """Table 3 as printed [kg, kg m²]."""

    table_4: PrintedByParameter
    """Table 4 as printed [kg, kg m²]."""

    printed_largest: float
    """Largest absolute error of Table 4 over the compared entries [kg, kg m²]."""

    printed_rms: float
    """Root mean square of these errors [kg, kg m²]."""

    compared: Count
    """Entries that the data determine and the paper prints."""

    implied_moment: float
    """J_22 and J_33 of B_1 by the cylinder formula with the mean of its printed masses [kg m²]."""

    trials: Sequence[TrialRecord]
    """Identifications: exact data, then data of seven digits."""


def paper_identification_record(found: PaperIdentification) -> PaperIdentificationRecord:
    return taken(
        PaperIdentificationRecord,
        found,
        why=WHY_TABLE_3,
        true=_by_parameter(found.true),
        table_3={name: [printed_number_record(number) for number in row] for name, row in TABLE_3.rows.items()},
        table_4={name: [printed_number_record(number) for number in row] for name, row in TABLE_4.rows.items()},
        compared=int(found.compared.sum()),
        implied_moment=found.implied,
        trials=[_trial(trial, found) for trial in (found.exact, found.together, *found.rounded)],
    )


def _trial(trial: PaperTrial, found: PaperIdentification) -> TrialRecord:
    return taken(
        TrialRecord,
        trial,
        values=_by_parameter(trial.values),
        errors=_by_parameter(trial.errors),
        standard_deviations=_by_parameter(trial.standard_deviations),
        largest=trial.largest(found.compared),
        rms=trial.rms(found.compared),
    )


def _by_parameter(values: Array) -> Mapping[str, list[float]]:
    return {name: row.tolist() for name, row in zip(PARAMETERS, np.asarray(values), strict=True)}


@dataclass(frozen=True, kw_only=True)
class MultiplierRecord:
    """One multiplier."""

    name: str
    """λ_jk: joint j, number k."""

    printed: str | None
    """As printed, digit by digit; null where the paper prints a dash."""

    reading: str | None
    """What a misprint should read."""

    erratum: str | None
    """Number of the misprint in docs/deviations.md."""

    ours: Number
    """From the printed rows [N, N m]; null where they do not determine it."""

    kind: Literal["reproduced", "rounding", "free", "unexplained"]
    """What the number is."""

    meaning: str
    """The same in words."""

    digits: Annotated[int, Keywords(minimum=0, maximum=7)]
    """Significant digits of seven that agree, where the kind is reproduced; otherwise 0."""


@dataclass(frozen=True, kw_only=True)
class PaperRatioRecord:
    """Of one joint."""

    joint: Count
    """Number of the joint."""

    printed: float
    """λ_j4 / λ_j5 as printed."""

    null_vector: Number
    """That of the null vector of its two axis rows; null where they are independent."""


@dataclass(frozen=True, kw_only=True)
class AsPrintedRecord:
    """Section 3.2 from the printed rows."""

    why: str
    """Why numbers differ, and which cannot be reproduced."""

    rank: Count
    """Of the printed rows of φ_q at 1.5 s."""

    n_rows: Count
    """How many rows there are."""

    multipliers: Annotated[Sequence[MultiplierRecord], Keywords(minItems=30, maxItems=30)]
    """Eq. (113) … (118), in their order."""

    ratios: Sequence[PaperRatioRecord]
    """Of the joints whose axis is horizontal."""


@dataclass(frozen=True, kw_only=True)
class CorrectedRecord:
    """Section 3.2 from the corrected model, at 1.5 s."""

    why: str
    """Why the printed numbers differ."""

    difference: Number
    """Of the multipliers from those of rnea, relative to the largest of their kind."""

    multipliers: Annotated[Sequence[Annotated[Sequence[float], Keywords(minItems=5, maxItems=5)]], SIX]
    """λ_1 … λ_5 per joint [N, N m], as in docs/notation.md."""

    rnea: Annotated[Sequence[Annotated[Sequence[float], Keywords(minItems=5, maxItems=5)]], SIX]
    """What the joint wrenches of Pinocchio's rnea amount to [N, N m]."""

    tau: Annotated[Sequence[float], SIX]
    """Torques of the actuators [N m]."""

    forces: Annotated[Sequence[Vector3], SIX]
    """Of the inside body on body j, world axes [N]."""

    moments: Annotated[Sequence[Vector3], SIX]
    """The same about O_j, actuator included, world axes [N m]."""

    reading: Annotated[Sequence[str], SIX]
    """What each joint carries, in words."""


def as_printed_record(found: Reproduction) -> AsPrintedRecord:
    return AsPrintedRecord(
        why=WHY_PRINTED,
        rank=found.printed.rank,
        n_rows=found.printed.n_rows,
        multipliers=[
            taken(MultiplierRecord, number, **vars(printed_number_record(number.printed)), meaning=KINDS[number.kind])
            for number in found.numbers
        ],
        ratios=[
            PaperRatioRecord(joint=joint, printed=printed, null_vector=found.printed.ratios.get(joint))
            for joint, printed in printed_ratios().items()
        ],
    )


def corrected_record(found: Reproduction) -> CorrectedRecord:
    return taken(CorrectedRecord, found.corrected, why=WHY_CORRECTED)


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
