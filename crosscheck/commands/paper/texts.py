"""Numbers of the paper and graphdyn's beside them, as text."""

from __future__ import annotations

import math
from collections.abc import Iterable

from crosscheck.paper.multipliers import Multiplier
from crosscheck.paper.printed import Printed
from crosscheck.report.report import NO_VALUE, Column

BODY_TABLE_COLUMNS = tuple(Column(f"B_{i}", "number") for i in range(1, 7))


def printed_text(number: Printed) -> str:
    """The number as printed, with the number of its erratum."""
    if number.text is None:
        return NO_VALUE
    return f"{number.text} {number.erratum or ''}".strip()


def misprints(numbers: Iterable[Printed]) -> str:
    """What every misprint among these should read, as sentences."""
    return " ".join(
        f"{number.text} is a misprint for {number.reading} ({number.erratum})." for number in numbers if number.erratum
    )


def value_text(value: float) -> str:
    """The value with the four decimal places of the paper; no minus before a zero."""
    return NO_VALUE if math.isnan(value) else f"{round(value, 4) + 0.0:.4f}"


def error_text(error: float) -> str:
    """An error far below the places of the paper."""
    if math.isnan(error):
        return NO_VALUE
    return f"{error:.0e}" if error else "0"


def multiplier_text(number: Multiplier) -> str:
    """The multiplier with the seven digits of the paper; zero for what is rounding of zero."""
    if math.isnan(number.ours):
        return NO_VALUE
    return "0" if number.kind == "rounding" else f"{number.ours:.6e}"
