"""Words and numbers of the report of a study."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from crosscheck.report.report import NO_VALUE
from crosscheck.study.settings.design import Source
from crosscheck.study.statistics.intervals import Interval
from crosscheck.study.statistics.outcomes import Measures

METHOD_CLASSES: dict[Measures, tuple[str, str]] = {
    "torques": ("Methods that measure torques", "torques"),
    "wrenches": ("Methods that measure wrenches in every joint", "wrenches"),
}
"""Names of the classes in headings and in tables. The two are never compared: a wrench has six numbers where a torque
is one."""

ERRORS_IN_WORDS = {
    "parameter_error": "parameter error",
    "torque_error": "torque error",
    "trajectory_error": "trajectory error",
}

SOURCES_IN_WORDS: dict[Source, str] = {
    "noise": "noise",
    "motion": "motion",
    "cad": "CAD model",
    "start": "start of iterations",
}

HEADLINE_ERROR = "torque_error"
"""The error of the verdict and of the terminal: of torques of another motion, which users of a model meet first."""


def interval_text(found: Interval, form: str, factor: float = 1.0) -> str:
    """Such as "2.10 (1.4–3.2)"."""
    if np.isnan(found.value):
        return NO_VALUE
    value, low, high = (_text(factor * x, form) for x in (found.value, found.low, found.high))
    return value if np.isnan(found.low) else f"{value} ({low}–{high})"


def listed(names: Iterable[str]) -> str:
    """Such as "a, b and c"."""
    *several, last = [*names] or [""]
    return f"{', '.join(several)} and {last}" if several else last


def percent_text(found: Interval) -> str:
    """A share or a relative error in percent, without the sign."""
    return interval_text(found, ".2g", 100.0)


def _text(value: float, form: str) -> str:
    """Text without exponents for whole percents, such as 100."""
    return "∞" if np.isinf(value) else f"{value:.0f}" if 99 < abs(value) < 1e5 else format(value, form)
