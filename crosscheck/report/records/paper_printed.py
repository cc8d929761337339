"""A printed number in `graphdyn paper 1`, and what its tables have in common."""

from __future__ import annotations

from dataclasses import dataclass

from crosscheck.report.records._fields import Keywords
from crosscheck.studies.paper.printed import Printed

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
