"""The design of a study: what each run draws anew, and which methods are compared with which."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal, get_args

from crosscheck.study.settings.settings import Settings, number, one_of, texts, whole, yes_or_no

Source = Literal["noise", "motion", "cad", "start"]
"""What a run draws: noise; motion, also the held-out one; errors of the CAD model; start of iterations."""

SOURCES: tuple[Source, ...] = get_args(Source)

Pairing = Literal["reference", "all"]
"""Pairs of methods that are compared: each with the reference, or each with each."""

DEFAULT_REFERENCE = "wls"

MAX_REPEATS = 1000
"""Largest number of draws of one source in a run."""

Stream = tuple[int, int]
"""Numbers of a run and of a repeat in it: which random numbers of a source are drawn."""


@dataclass(frozen=True)
class Draw:
    """The random numbers of one record, source by source. Scenarios of a run share them."""

    noise: Stream = (0, 0)
    motion: Stream = (0, 0)
    cad: Stream = (0, 0)
    start: Stream = (0, 0)


@dataclass(frozen=True)
class Redraw:
    """A record of a run in which one source is drawn once more. repeat: from 1; 0 for the run itself, without source"""

    source: Source | None = None
    repeat: int = 0


COMMON_DRAW, RUN_ITSELF = Draw(), Redraw()
"""What all runs share where nothing varies; the record of a run with its own random numbers."""


@dataclass(frozen=True)
class StudyDesign:
    """What the runs of a study have of their own, and what is asked of them.

    vary: sources that every run draws anew; the others are the same in all runs
    repeats: draws of every source that varies in one run, with all others as they are
    reference: method that others are compared with, as in tables; None: DEFAULT_REFERENCE where it takes part, else
        the first method
    pairs: which methods are compared
    region: errors that differ by less than this part are equivalent
    distances: whether those of Leboutet et al. (2021) are computed too
    """

    vary: tuple[Source, ...] = SOURCES
    repeats: int = 1
    reference: str | None = None
    pairs: Pairing = "reference"
    region: float = 0.05
    distances: bool = False

    def draw(self, run: int, redraw: Redraw = RUN_ITSELF) -> Draw:
        """The random numbers of a record of a run."""
        drawn = Draw(**dict.fromkeys(self.vary, (run, 0)))
        if redraw.source is None:
            return drawn
        return replace(drawn, **{redraw.source: (run, redraw.repeat)})

    @property
    def redraws(self) -> tuple[Redraw, ...]:
        """All records of a run, the run itself first."""
        return RUN_ITSELF, *(Redraw(source, k) for source in self.vary for k in range(1, self.repeats))


DEFAULT_DESIGN = StudyDesign()


def study_design(table: Settings, named: Callable[[object], str]) -> StudyDesign:
    """What the table [study] says of it. named: a reader of the name of a method, as in tables. BadConfiguration."""
    return StudyDesign(
        table.take("vary", SOURCES, _sources),
        table.take("repeats", 1, whole(1, MAX_REPEATS)),
        table.take("reference", None, named),
        table.take("pairs", "reference", one_of(get_args(Pairing))),  # type: ignore[arg-type]
        table.take("region", 0.05, lambda value: number(value, above=0.0)),
        table.take("distances", False, yes_or_no),
    )


def _sources(value: object) -> tuple[Source, ...]:
    given = texts(f"what each run draws anew, of {', '.join(SOURCES)}")(value)
    if not given or not set(given) <= set(SOURCES):
        raise ValueError(f"give a list of what each run draws anew, of {', '.join(SOURCES)}")
    return tuple(source for source in SOURCES if source in given)
