"""The format `graphdyn paper 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from crosscheck.commands.errata.record import EffectRecord
from crosscheck.paper.errata import ERRATA
from crosscheck.paper.multipliers import WHY_PRINTED, CorrectedMultipliers, Multiplier, printed_ratios
from crosscheck.paper.printed import PARAMETERS, TABLE_3, TABLE_4, Printed
from crosscheck.paper.reproduction import WHY_CORRECTED, Check, Reproduction
from crosscheck.paper.tables import WHY_TABLE_2, WHY_TABLE_3, GeometryTable, PaperIdentification, PaperTrial
from crosscheck.report.records.record import CommandRecord, Count, Keywords, Number, Record, attribute, written
from graphdyn.layout import Array

SIX = Keywords(minItems=6, maxItems=6)
"""One entry per body or joint."""


class PrintedNumberRecord(Record, of=Printed, leave_out=("text",)):
    """One printed number."""

    printed = attribute("text")


PARAMETER_KEYWORDS = Keywords(required=list(PARAMETERS))
ByParameter = Annotated[Mapping[str, Annotated[Sequence[Number], SIX]], PARAMETER_KEYWORDS]
PrintedByParameter = Annotated[Mapping[str, Annotated[Sequence[PrintedNumberRecord], SIX]], PARAMETER_KEYWORDS]


class PaperTrialRecord(Record, of=PaperTrial):
    """One identification.

    largest: largest absolute error over the compared entries [kg, kg m²]
    rms: root mean square of these errors [kg, kg m²]
    """

    values: ByParameter
    errors: ByParameter
    standard_deviations: ByParameter
    rank: Count
    largest: float
    rms: float


class PaperIdentificationRecord(Record, of=PaperIdentification, only=("true", "implied_moment")):
    """Tables 3 and 4.

    why: reason why numbers differ
    table_3, table_4: as printed [kg, kg m²]
    compared: entries that the data determine and the paper prints
    trials: identifications: exact data, then data of seven digits
    """

    why: str
    true: ByParameter
    table_3: PrintedByParameter
    table_4: PrintedByParameter
    printed_largest = attribute()
    printed_rms = attribute()
    compared: Count
    trials: Sequence[PaperTrialRecord]


class MultiplierRecord(Record, of=Multiplier, leave_out=("joint", "number")):
    """One multiplier."""

    name = attribute()
    printed = attribute("printed.text")
    reading = attribute("printed.reading")
    erratum = attribute("printed.erratum")
    meaning = attribute()
    digits: Annotated[int, Keywords(minimum=0, maximum=7)]


class PaperRatioRecord(Record):
    """A ratio of multipliers of one joint.

    joint: number of the joint
    printed: λ_j4 / λ_j5 as printed
    null_vector: that of the null vector of its two axis rows; null where they are independent
    """

    joint: Count
    printed: float
    null_vector: Number


class AsPrintedRecord(Record, of=Reproduction, only=()):
    """Section 3.2 from the printed rows.

    why: reason why numbers differ, and which cannot be reproduced
    rank: of the printed rows of φ_q at 1.5 s
    n_rows: how many rows there are
    multipliers: Eq. (113) … (118), in their order (30,)
    ratios: of the joints whose axis is horizontal
    """

    why: str
    rank: Count = attribute("printed.rank")
    n_rows: Count = attribute("printed.n_rows")
    multipliers: Sequence[MultiplierRecord] = attribute("numbers")
    ratios: Sequence[PaperRatioRecord]


class CorrectedRecord(Record, of=CorrectedMultipliers):
    """Section 3.2 from the corrected model, at 1.5 s.

    why: reason why the printed numbers differ
    """

    why: str
    difference: Number


class CheckRecord(Record, of=Check):
    """One check."""

    measured: Number
    agrees = attribute()


class RowRecord(Record):
    """A row of Table 2.

    name: row, with its unit
    printed: as printed (6,)
    ours: not rounded: lengths and radii as given, the rest from density and geometry (6,) [m, kg, kg m²]
    """

    name: str
    printed: Sequence[str]
    ours: Sequence[float]


class Table2(Record):
    """Geometry, masses and moments of inertia.

    why: reason why numbers differ, or that they do not
    rows: of Table 2 (6,)
    """

    why: str
    rows: Sequence[RowRecord]


class RankRecord(Record):
    """The rank at one time.

    time: of the motion [s]
    rank: of the 30 printed rows
    """

    time: float
    rank: Count


class OverTimeRecord(Record):
    """The whole motion of section 3.1.

    samples: number of times
    difference: of multipliers, forces, moments and torques from those of rnea, relative to the largest of their kind
    ranks: when the printed rows have which rank
    """

    samples: Count
    difference: Number
    ranks: Sequence[RankRecord]


class PaperErrataRecord(Record):
    """What the printed errors do, as in graphdyn errata --json.

    samples: random states per robot
    seed: of the random states
    sentences: what each erratum is, by its number
    effects: one record per erratum, robot and, for A3, distance from gimbal lock
    """

    samples: Count
    seed: Count
    sentences: Mapping[str, str]
    effects: Sequence[EffectRecord]


class PaperRecord(CommandRecord, format="graphdyn paper 1"):
    """Every table and result of the paper beside the corrected model. Columns are bodies or joints 1 … 6.

    agrees: every check holds
    checks: what must hold, in the order of the paper
    table_2: geometry, masses and moments of inertia
    identification: Tables 3 and 4
    as_printed: section 3.2 from the printed rows
    corrected: section 3.2 from the corrected model, at 1.5 s
    over_time: the whole motion of section 3.1
    errata: what the printed errors do, as in graphdyn errata --json
    """

    agrees: bool
    checks: Sequence[CheckRecord]
    table_2: Table2
    identification: PaperIdentificationRecord
    as_printed: AsPrintedRecord
    corrected: CorrectedRecord
    over_time: OverTimeRecord
    errata: PaperErrataRecord


def record(found: Reproduction, command: Sequence[str]) -> dict[str, Any]:
    """Everything but the curves of the pictures."""
    return written(
        PaperRecord,
        found,
        command=command,
        table_2=written(Table2, why=WHY_TABLE_2, rows=_rows(found.geometry)),
        identification=_identification(found.identification),
        as_printed=written(AsPrintedRecord, found, why=WHY_PRINTED, ratios=_ratios(found.printed.ratios)),
        corrected=written(CorrectedRecord, found.corrected, why=WHY_CORRECTED),
        over_time=written(
            OverTimeRecord,
            found.over_time,
            samples=len(found.over_time.recording.time),
            ranks=[{"time": time, "rank": rank} for time, rank in found.over_time.ranks.items()],
        ),
        errata=written(PaperErrataRecord, found, sentences=ERRATA),
    )


def _rows(geometry: GeometryTable) -> list[dict[str, Any]]:
    return [
        {"name": name, "printed": [number.text for number in printed], "ours": ours}
        for name, printed, ours in zip(geometry.rows, geometry.printed, geometry.ours, strict=True)
    ]


def _ratios(found: Mapping[int, float]) -> list[dict[str, Any]]:
    return [
        {"joint": joint, "printed": printed, "null_vector": found.get(joint)}
        for joint, printed in printed_ratios().items()
    ]


def _identification(found: PaperIdentification) -> dict[str, Any]:
    return written(
        PaperIdentificationRecord,
        found,
        why=WHY_TABLE_3,
        true=_by_parameter(found.true),
        table_3=TABLE_3.rows,
        table_4=TABLE_4.rows,
        compared=int(found.compared.sum()),
        trials=[_trial(trial, found) for trial in (found.exact, found.together, *found.rounded)],
    )


def _trial(trial: PaperTrial, found: PaperIdentification) -> dict[str, Any]:
    return written(
        PaperTrialRecord,
        trial,
        values=_by_parameter(trial.values),
        errors=_by_parameter(trial.errors),
        standard_deviations=_by_parameter(trial.standard_deviations),
        largest=trial.largest(found.compared),
        rms=trial.rms(found.compared),
    )


def _by_parameter(values: Array) -> dict[str, Array]:
    return dict(zip(PARAMETERS, values, strict=True))
