"""What `graphdyn paper 1` says of section 3.2, the multipliers: from the printed rows, and from the corrected model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

from crosscheck.report.records._fields import Count, Keywords, Number, Vector3, taken
from crosscheck.report.records.paper_printed import SIX, printed_number_record
from crosscheck.studies.paper.multipliers import KINDS, WHY_PRINTED, printed_ratios
from crosscheck.studies.paper.reproduction import Reproduction
from crosscheck.studies.paper.why import WHY_CORRECTED


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
