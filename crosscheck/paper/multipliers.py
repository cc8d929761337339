"""Eq. (113)-(118) number by number: which are reproduced, and why the others cannot be."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from crosscheck.paper.as_printed import PrintedMultipliers
from crosscheck.paper.printed import MULTIPLIERS, Printed

MIN_REPRODUCED_DIGITS = 6
"""Number of equal significant digits from which a multiplier is reproduced: the paper has seven, with rounding."""

PRINTED_DIGITS = 7

Kind = Literal["reproduced", "rounding", "free", "unexplained"]

MEANINGS: Mapping[Kind, str] = {
    "reproduced": "reproduced",
    "rounding": "zero; the paper prints rounding of its seven digits",
    "free": "not determined: the two axis rows of this joint are dependent (A2)",
    "unexplained": "not reproduced: no interpretation of the text known to us gives these two",
}
"""Kinds of printed numbers, in words."""

WHY_PRINTED = (
    "λ_j3 is the weight outside joint j, since B was formed from measured joint forces without gravity (C4); λ_33 is "
    "printed without its minus (B6). The axes of joints 2, 3 and 5 are horizontal and their two axis rows dependent "
    "(A2): the printed 1e10 to 1e11 are a null vector divided by rounding, whose size no program can reproduce; its "
    "ratio is tan 33.75°, the angle of joint 1. λ_44 and λ_45 follow when joint 5 passes the moment about its axis on "
    "to joint 4. λ_14 and λ_15 are not reproduced. λ_42 = 30.072190e-4 has one digit too many, and is rounding anyway."
)


@dataclass(frozen=True)
class Multiplier:
    """One of the thirty multipliers.

    joint, number: j and k of λ_jk; printed: in the paper
    ours: from the printed rows, NaN where they do not determine it [N, N m]
    kind: what the printed number is
    digits: significant digits of seven that agree, where the kind is reproduced; otherwise 0
    """

    joint: int
    number: int
    printed: Printed
    ours: float
    kind: Kind
    digits: int

    @property
    def name(self) -> str:
        """λ_jk: joint j, number k."""
        return f"λ_{self.joint}{self.number}"

    @property
    def meaning(self) -> str:
        """The kind in words."""
        return MEANINGS[self.kind]


def agreeing_digits(printed: float, ours: float) -> int:
    """Number of significant digits, at most seven, to which two numbers agree within half a unit of the last digit."""
    if not (math.isfinite(printed) and math.isfinite(ours)) or printed == 0:
        return 0
    exponent = math.floor(math.log10(abs(printed)))
    fitting = (k for k in range(PRINTED_DIGITS, 0, -1) if abs(printed - ours) <= 0.5 * 10.0 ** (exponent - k + 1))
    return next(fitting, 0)


def multipliers(solved: PrintedMultipliers) -> tuple[Multiplier, ...]:
    """λ_61 … λ_65, λ_51 … λ_15, in the order of the paper."""
    rows = tuple(MULTIPLIERS.rows.values())
    return tuple(
        _multiplier(solved, joint, number, rows[number - 1][joint - 1])
        for joint in range(6, 0, -1)
        for number in range(1, 6)
    )


def _multiplier(solved: PrintedMultipliers, joint: int, number: int, printed: Printed) -> Multiplier:
    ours = float(solved.values[joint - 1, number - 1])
    kind: Kind
    if number in (1, 2):
        kind = "rounding"
    elif np.isnan(ours):
        kind = "free"
    else:
        kind = "unexplained" if joint == 1 and number > 3 else "reproduced"
    digits = agreeing_digits(printed.value, ours) if kind == "reproduced" else 0
    return Multiplier(joint, number, printed, ours, kind, digits)


def printed_ratios() -> Mapping[int, float]:
    """λ_j4 / λ_j5 as printed, of the joints whose rows are dependent."""
    fourth, fifth = MULTIPLIERS.values[3:5]
    return {j: float(fourth[j - 1] / fifth[j - 1]) for j in (2, 3, 5)}
