"""The reproduction of the paper that `graphdyn paper` shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from crosscheck.paper.checks import Check, checks
from crosscheck.paper.corrected import CorrectedMultipliers, OverTime, corrected_multipliers, over_time
from crosscheck.paper.errata import Effect, measure
from crosscheck.paper.multipliers import Multiplier, PrintedMultipliers, multipliers, printed_multipliers
from crosscheck.paper.tables import GeometryTable, PaperIdentification, geometry_table, identify

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


def reproduce(samples: int, seed: int = 0, progress: Callable[[str], None] | None = None) -> Reproduction:
    """Compute every part; progress is called with the name of each when it is done."""

    def done(what: str) -> None:
        if progress:
            progress(what)

    geometry = geometry_table()
    done(PROGRESS_STEPS[0])
    identification = identify()
    done(PROGRESS_STEPS[1])
    printed = printed_multipliers()
    numbers = multipliers(printed)
    done(PROGRESS_STEPS[2])
    corrected = corrected_multipliers()
    done(PROGRESS_STEPS[3])
    motion = over_time()
    done(PROGRESS_STEPS[4])
    effects = tuple(measure(samples, seed, lambda effect: done(f"{effect.erratum} on {effect.robot}")))
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
