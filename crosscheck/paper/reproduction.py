"""The reproduction of the paper that `graphdyn paper` shows, and its checks: each number with its bound and the reason.

Explained here are the experiment, the corrected section 3.2 and the errata; other modules have their own explanations.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from crosscheck.paper.errata import Effect, measure
from crosscheck.paper.multipliers import (
    MIN_REPRODUCED_DIGITS,
    CorrectedMultipliers,
    Multiplier,
    OverTime,
    PrintedMultipliers,
    corrected_multipliers,
    multipliers,
    over_time,
    printed_multipliers,
    printed_ratios,
)
from crosscheck.paper.tables import GeometryTable, PaperIdentification, geometry_table, identify

EXPERIMENT_NOTE = (
    "From rest the carriage accelerates at 2 m/s² along world x, joint 1 at +30°/s² about the vertical, joint 2 at "
    "-30°/s² about its e_2; joints 3 to 6 are locked. The paper's 9.5493 rad/s² is 30/π, a misprint for "
    "0.523599 rad/s² (B4)."
)

WHY_CORRECTED = (
    "Gravity and the whole motion are in B, and the two axis rows are normal to each axis: rank 30, thirty finite "
    "multipliers, equal to the joint wrenches of rnea. The printed ones differ because they are not constraint forces "
    "of the motion (C4): the moments that the paper looks for in λ_j4, λ_j5 of joints 2, 3 and 5 are the torques of "
    "their actuators, and of the moments the bearings carry only those across the axis."
)

WHY_ERRATA = (
    "Each printed error is put back alone into the correct model of two arms, at random states; Pinocchio's aba and "
    "rnea are the reference. Errors are relative to the largest entry; a single state says little, so quantiles are "
    "given."
)


EXACT_PARAMETER_BOUND = 1e-9
"""Bound on the relative error of a parameter identified from exact data."""

REFERENCE_BOUND = 1e-12
"""Bound on the relative difference from rnea."""

QUOTIENT_BOUND = 1e-6
"""Bound on the relative error of a quotient of two numbers of seven digits."""

CORRECTED_FORM_BOUND = 1e-11
"""Bound on the relative error of the corrected forms of the errata."""

PRINTED_RANKS = {0.0: 25, 1.5: 27}
"""Rank of the 30 printed rows, by time [s] (A2)."""

N_DETERMINED = 33
"""Number of the 36 parameters of Table 3 that the data determine."""

N_REPRODUCED = 10
"""Number of multipliers of Eq. (113)-(118) that the text determines: six λ_j3, λ_64, λ_65, λ_44, λ_45."""


@dataclass(frozen=True)
class Check:
    """One number against its bound.

    where: table, equation or section; what: was measured, in words, with its unit unless it has none
    measured: its value; bound: what it must not exceed, or not fall below; why: this bound
    at_least: whether the bound is a lower one
    """

    where: str
    what: str
    measured: float
    bound: float
    why: str
    at_least: bool = False

    @property
    def agrees(self) -> bool:
        """Whether the number is within its bound; NaN is not."""
        return self.measured >= self.bound if self.at_least else self.measured <= self.bound


def checks(
    geometry: GeometryTable,
    identification: PaperIdentification,
    printed: PrintedMultipliers,
    numbers: Sequence[Multiplier],
    corrected: CorrectedMultipliers,
    motion: OverTime,
    effects: Sequence[Effect],
) -> tuple[Check, ...]:
    """All checks, in the order of the paper."""
    reproduced = [number for number in numbers if number.kind == "reproduced"]
    weight = _largest(abs(number.ours) for number in reproduced)
    noise = _largest(abs(number.ours) for number in numbers if number.kind == "rounding")
    ranks = _largest(abs(motion.ranks[time] - rank) for time, rank in PRINTED_RANKS.items())
    ratios = printed_ratios()
    ratio = _largest(abs(printed.ratios.get(joint, math.nan) / value - 1) for joint, value in ratios.items())
    repaired = [effect for effect in effects if effect.erratum != "A2"]
    missing = [effect for effect in effects if effect.erratum == "A2"]
    return (
        Check(
            "Table 2", "entries that differ in a printed digit", geometry.differing, 0, "the cylinder formula is exact"
        ),
        Check(
            "Table 3",
            "parameters that the data determine and the paper prints",
            int(identification.compared.sum()),
            N_DETERMINED,
            "all but m(e_2), J_22 and J_33 of B_1",
            at_least=True,
        ),
        Check(
            "Table 3",
            "exact data: largest relative error of a determined parameter",
            identification.exact_error,
            EXACT_PARAMETER_BOUND,
            "rounding times the condition number, below 1e2, with a large margin",
        ),
        Check(
            "Table 4",
            "7-digit data, worst trial: largest absolute error",
            identification.rounded_largest,
            identification.printed_largest,
            "the largest of the paper, over the entries both determine",
        ),
        Check(
            "Table 4",
            "7-digit data, worst trial: root mean square error",
            identification.rounded_rms,
            identification.printed_rms,
            "that of the paper, over the entries both determine",
        ),
        Check("Eq. (111)", "rank of the printed rows at 0 and 1.5 s: distance from 25 and 27", ranks, 0, "erratum A2"),
        Check(
            "Eq. (113)-(118)",
            "multipliers that the text determines",
            len(reproduced),
            N_REPRODUCED,
            "six λ_j3, λ_64, λ_65, λ_44, λ_45",
            at_least=True,
        ),
        Check(
            "Eq. (113)-(118)",
            "as printed: fewest agreeing significant digits of these",
            min((number.digits for number in reproduced), default=0),
            MIN_REPRODUCED_DIGITS,
            "the paper computes with seven digits",
            at_least=True,
        ),
        Check(
            "Eq. (113)-(118)",
            "as printed: largest λ_j1, λ_j2, relative to the largest weight",
            noise / weight,
            REFERENCE_BOUND,
            "they are zero; a few hundred roundings",
        ),
        Check(
            "Eq. (114), (116), (117)",
            "λ_j4 / λ_j5 of joints 2, 3, 5 against the null vector, relative",
            ratio,
            QUOTIENT_BOUND,
            "a quotient of two numbers of seven digits",
        ),
        Check(
            "section 3.2",
            "corrected: thirty multipliers against rnea at 1.5 s, relative",
            corrected.difference,
            REFERENCE_BOUND,
            "two algorithms, a few hundred roundings each",
        ),
        Check(
            "section 3",
            "the experiment against rnea at 101 times, relative",
            motion.difference,
            REFERENCE_BOUND,
            "two algorithms, a few hundred roundings each",
        ),
        Check(
            "errata",
            "corrected forms of A1, A3 … A6: largest relative error",
            _largest(effect.corrected for effect in repaired),
            CORRECTED_FORM_BOUND,
            "condition numbers below 1e4, a thousandfold margin over rounding",
        ),
        Check(
            "errata",
            "corrected form of A2: missing rank",
            _largest(effect.corrected for effect in missing),
            0,
            "rank 30",
        ),
    )


def _largest(values: Iterable[float]) -> float:
    """The largest value; NaN if one of them is NaN."""
    return float(np.max(list(values)))


PROGRESS_STEPS = (
    "Table 2",
    "Tables 3 and 4",
    "section 3.2 as printed",
    "section 3.2 corrected",
    "the experiment over time",
)
"""Steps that are computed before the errata."""


@dataclass(frozen=True, eq=False)
class Reproduction:
    """The paper and the corrected model.

    printed: section 3.2 solved with the printed rows; numbers: its thirty multipliers beside the printed ones
    samples, seed: random states of the errata
    checks: the numbers that must be within bounds
    """

    geometry: GeometryTable
    identification: PaperIdentification
    printed: PrintedMultipliers
    numbers: tuple[Multiplier, ...]
    corrected: CorrectedMultipliers
    over_time: OverTime
    samples: int
    seed: int
    effects: tuple[Effect, ...]
    checks: tuple[Check, ...]

    @property
    def agrees(self) -> bool:
        """Whether every reproduced number is within its bound."""
        return all(check.agrees for check in self.checks)


def reproduce(samples: int, seed: int = 0, progress: Callable[[str], None] = lambda _: None) -> Reproduction:
    """Compute every part; progress is called with the name of each when it is done."""
    geometry = geometry_table()
    progress(PROGRESS_STEPS[0])
    identification = identify()
    progress(PROGRESS_STEPS[1])
    printed = printed_multipliers()
    numbers = multipliers(printed)
    progress(PROGRESS_STEPS[2])
    corrected = corrected_multipliers()
    progress(PROGRESS_STEPS[3])
    motion = over_time()
    progress(PROGRESS_STEPS[4])
    effects = tuple(measure(samples, seed, lambda effect: progress(f"{effect.erratum} on {effect.robot}")))
    return Reproduction(
        geometry,
        identification,
        printed,
        numbers,
        corrected,
        motion,
        samples,
        seed,
        effects,
        checks(geometry, identification, printed, numbers, corrected, motion, effects),
    )
