"""Numbers of the paper and ours as text, the same on the terminal and on the page."""

import math

from crosscheck.studies.paper.multipliers import Multiplier
from crosscheck.studies.paper.printed import Printed

DASH = "–"
"""Not determined, or not printed."""


def printed_text(number: Printed) -> str:
    """As printed, with the number of its erratum."""
    if number.text is None:
        return DASH
    return f"{number.text} {number.erratum}".strip()


def value_text(value: float) -> str:
    """With the four decimal places of the paper; no minus before a zero."""
    return DASH if math.isnan(value) else f"{round(value, 4) + 0.0:.4f}"


def error_text(error: float) -> str:
    """An error far below the places of the paper."""
    if math.isnan(error):
        return DASH
    return f"{error:.0e}" if error else "0"


def multiplier_text(number: Multiplier) -> str:
    """With the seven digits of the paper; zero for what is rounding of zero."""
    if math.isnan(number.ours):
        return DASH
    return "0" if number.kind == "rounding" else f"{number.ours:.6e}"
