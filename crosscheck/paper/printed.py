"""The numbers of the paper, as printed: Tables 2, 3 and 4, Eq. (113)-(118), the experiment of section 3.1.

Digits are kept as text, including trailing zeros. A misprint has the correct number beside it, and its entry in
docs/deviations.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from graphdyn.layout import Array


@dataclass(frozen=True)
class Printed:
    """One printed number.

    text: as printed, digit by digit; None where the paper prints a dash
    reading: what a misprint should read; erratum: its number in docs/deviations.md
    """

    text: str | None
    reading: str | None = None
    erratum: str | None = None

    @property
    def value(self) -> float:
        """The correct number; NaN for a dash."""
        text = self.text if self.reading is None else self.reading
        return float("nan") if text is None else float(text)

    @property
    def decimal_places(self) -> int:
        """Number of digits behind the point, as printed."""
        return len((self.text or "").partition(".")[2])


@dataclass(frozen=True)
class PrintedTable:
    """where: table or equation; rows by name, one number per body B_1 … B_6."""

    where: str
    rows: Mapping[str, tuple[Printed, ...]]

    @property
    def values(self) -> Array:
        """The correct numbers (rows, 6)."""
        return np.array([[number.value for number in row] for row in self.rows.values()])


def _row(text: str) -> tuple[Printed, ...]:
    return tuple(Printed(None if word == "-" else word) for word in text.split())


def _misprint(row: tuple[Printed, ...], body: int, reading: str, erratum: str) -> tuple[Printed, ...]:
    return tuple(
        Printed(number.text, reading, erratum) if i == body else number for i, number in enumerate(row, start=1)
    )


PARAMETERS = ("m(e_1)", "m(e_2)", "m(e_3)", "J_11", "J_22", "J_33")
"""Rows of Tables 3 and 4: the mass from the force in each world direction [kg], principal moments [kg m²]."""

TABLE_2 = PrintedTable(
    "Table 2",
    {
        "length [m]": _row("1.045 1.245 1.21 0.315 0.29 0.3"),
        "radius [m]": _row("0.5 0.3 0.2 0.2 0.2 0.3"),
        "m [kg]": _row("6402.6012 2746.0726 1186.1661 308.7953 284.2877 661.7042"),
        "J_11 [kg m²]": _row("800.3251 123.5733 23.7233 6.1759 5.6858 29.7767"),
        "J_22 [kg m²]": _row("982.8126 416.4934 156.5838 5.6413 4.8353 19.8511"),
        "J_33 [kg m²]": _row("982.8126 416.4934 156.5838 5.6413 4.8353 19.8511"),
    },
)

TABLE_3 = PrintedTable(
    "Table 3",
    {
        "m(e_1)": _row("6402.6000 2746.0720 1186.1658 308.7958 284.2875 661.7041"),
        "m(e_2)": _row("- 2746.0723 1186.1661 308.7955 284.2875 661.7043"),
        "m(e_3)": _row("6402.5942 2746.0723 1186.1660 308.7955 284.2877 661.7042"),
        "J_11": _row("800.3252 123.6157 23.7206 6.1761 5.6856 29.7769"),
        "J_22": _row("982.8120 416.4683 156.5821 5.6412 4.8348 19.8511"),
        "J_33": _misprint(_row("982.8120 416.5109 156.5722 5.4619 4.8353 19.8514"), 4, "5.6419", "B5"),
    },
)

TABLE_4 = PrintedTable(
    "Table 4",
    {
        "m(e_1)": _row("-0.0012 -0.0006 -0.0002 0.0005 -0.0002 -0.0001"),
        "m(e_2)": _row("- -0.0003 0.0000 0.0002 -0.0002 0.0001"),
        "m(e_3)": _row("-0.0070 -0.0003 -0.0001 0.0002 0.0000 0.0000"),
        "J_11": _row("0.0001 0.0424 -0.0027 0.0002 -0.0002 0.0002"),
        "J_22": _row("-0.0006 -0.0251 -0.0017 -0.0001 -0.0005 0.0000"),
        "J_33": _row("-0.0006 0.0175 -0.0116 0.0006 0.0000 0.0003"),
    },
)
"""Bodies in the order of Table 3; the paper prints B_6 first, and 0 for 0.0000."""

MULTIPLIERS = PrintedTable(
    "Eq. (113)-(118)",
    {
        "λ_j1": _row("4.197760e-3 1.797760e-3 2.941508e-4 -3.836233e-4 5.154353e-4 1.356146e-4"),
        "λ_j2": _row("1.664961e-4 1.664961e-4 3.263078e-4 30.072190e-4 -2.726663e-4 3.870958e-4"),
        "λ_j3": _misprint(
            _row("-1.136554e5 -5.086735e4 2.393758e4 -1.230526e4 -9.277012e3 -6.489101e3"), 3, "-2.393758e4", "B6"
        ),
        "λ_j4": _row("-5.868432e3 -1.233380e11 -1.431100e11 8.285916e3 -1.631801e10 1.211238e3"),
        "λ_j5": _row("-1.877410e-4 -1.845883e11 -2.141792e11 5.536472e3 -2.442163e10 8.093237e2"),
    },
)
"""Columns are joints 1 … 6; Eq. (113) is joint 6, Eq. (118) joint 1."""

SAMPLE_TIMES = (0.3, 0.6, 0.9, 1.2, 1.5)
"""Times of the five sets of data of Tables 3 and 4 [s]."""

POSE_TIMES = {"Figure 2": 0.0, "Figure 11": 1.5, "Figure 10": 2.0}
"""Times at which the paper draws the arm [s]."""
