"""What a result is: each command turns its result into one Report; text, page and JSON are renderings of it.

A report is a verdict, sections of blocks, and the record that goes into the JSON file. A block is a table, facts,
notes, a picture, a plot, code or prose; `on` says whether it is for the terminal, the page, or both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from graphdyn.layout import Array

if TYPE_CHECKING:
    from markupsafe import Markup

    from crosscheck.viewing.figures import Figure

State = Literal["agrees", "undecided", "disagrees", "plain"]
Medium = Literal["text", "page"]
Kind = Literal["name", "text", "number", "vector", "verdict"]

Recorder = Callable[[Sequence[str]], object]
"""Makes the record of the JSON file, a dataclass of crosscheck.report.records, from the arguments of the program."""

VERDICT_SYMBOLS: dict[State, str] = {"agrees": "✓", "undecided": "?", "disagrees": "✗", "plain": ""}
"""Before a verdict on the page: no reader depends on color."""

WIDE_LINE_CHARACTERS = 120
"""Characters of a line from which tables have room for columns that explain."""

FAILURES_FIRST: dict[State, int] = {"disagrees": 0, "undecided": 1, "agrees": 2, "plain": 2}
NO_VALUE = "–"
"""A cell without a value."""


@dataclass(frozen=True)
class Verdict:
    """words: "agrees", "DISAGREES", …; reason: in a sentence or two, "" where the words say it all.

    sentence: the headline of a page, where the words alone are no sentence
    """

    state: State
    words: str
    reason: str = ""
    sentence: str = ""


@dataclass(frozen=True)
class Column:
    """One column of a table.

    kind: "name" (cut on a page where it is long, whole on hover), "text", "number" (to the right), "vector"
        (several numbers), "verdict"
    unit: shown behind the title
    form: how a value becomes text: a format such as ".1e", or a function; None and NaN are NO_VALUE in any case
    meaning: shown on hover
    from_width: left out on terminals narrower than this [characters]; the page has all columns
    """

    title: str
    kind: Kind = "text"
    unit: str = ""
    form: str | Callable[[Any], str] = ""
    meaning: str = ""
    from_width: int = 0

    @property
    def heading(self) -> str:
        return f"{self.title} [{self.unit}]" if self.unit else self.title

    def text(self, value: Any) -> str:
        if isinstance(value, Hover):
            return self.text(value.value)
        if isinstance(value, Verdict):
            return value.words
        if value is None or (isinstance(value, float | np.floating) and value != value):
            return NO_VALUE
        if isinstance(value, float | np.floating) and np.isinf(value):
            return "∞" if value > 0 else "−∞"
        return self.form(value) if callable(self.form) else format(value, self.form)


@dataclass(frozen=True)
class Hover:
    """A cell that says more where a pointer rests on it."""

    value: Any
    more: str


@dataclass(frozen=True)
class Row:
    """cells: a value per column; a Verdict among them colors itself.

    state: "disagrees" marks the row and, in a table that sorts, puts it first
    rule: a line above it, where a new group begins
    link: key of the section or group that tells more
    """

    cells: tuple[Any, ...]
    state: State = "plain"
    rule: bool = False
    link: str | None = None


@dataclass(frozen=True, kw_only=True)
class Block:
    """title: a heading above it; on: where it is shown; folded: closed on the page until it is opened."""

    title: str = ""
    on: tuple[Medium, ...] = ("text", "page")
    folded: bool = False


@dataclass(frozen=True)
class Table(Block):
    """caption: what its numbers are; failures_first: rows in the order of FAILURES_FIRST, otherwise as given

    repeated: number of leading columns that come again where a terminal is too narrow for all columns at once
    compact: without frames on the terminal, columns one space apart: many short numbers beside each other
    """

    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    caption: str = ""
    failures_first: bool = True
    repeated: int = 1
    compact: bool = False

    @property
    def ordered(self) -> Sequence[Row]:
        return sorted(self.rows, key=lambda row: FAILURES_FIRST[row.state]) if self.failures_first else self.rows


@dataclass(frozen=True)
class Facts(Block):
    """Names and what is to be said of each, in order."""

    items: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Prose(Block):
    """One paragraph. apart: an empty line above it on the terminal"""

    text: str
    soft: bool = False
    apart: bool = False


@dataclass(frozen=True)
class Note:
    """code: of its kind, notes of one kind are grouped; where: the element it is about, "" for the whole"""

    text: str
    code: str = ""
    where: str = ""
    state: State = "plain"


@dataclass(frozen=True)
class Notes(Block):
    notes: tuple[Note, ...]


@dataclass(frozen=True)
class Code(Block):
    """Text to be copied, such as Python that reproduces a number."""

    text: str


@dataclass(frozen=True)
class Lines(Block):
    """Lines of equal characters, side by side with other blocks of this kind where there is room."""

    lines: tuple[str, ...]


@dataclass(frozen=True)
class CharacterPicture(Block):
    """A drawing for the terminal. draw: called with the width of a line, gives lines, none where it is too wide."""

    draw: Callable[[int], Sequence[str]]
    caption: str = ""
    on: tuple[Medium, ...] = field(default=("text",), kw_only=True)


@dataclass(frozen=True)
class Picture(Block):
    """A drawing that nobody needs to zoom into. draw: called with a key that keeps its ids apart, gives an <svg>."""

    draw: Callable[[str], Markup]
    caption: str = ""
    wide: bool = True


@dataclass(frozen=True)
class RobotPicture(Picture):
    """The picture of the robot that a report is about."""


@dataclass(frozen=True)
class Stage(Block):
    """Robots in three dimensions, which a reader moves and plays: the page of crosscheck.viewing inside the page."""

    figures: tuple[Figure, ...]
    on: tuple[Medium, ...] = field(default=("page",), kw_only=True)


@dataclass(frozen=True)
class Series:
    """One curve over the x of its plot; NaN where it has no value.

    style: "line", "dashed" (drawn over lines), or "marks"
    hidden: switched off until a reader switches it on; left out of the static picture
    low, high: ends of an upright bar at every point, such as quartiles      (N,)
    """

    name: str
    y: Array
    style: Literal["line", "dashed", "marks"] = "line"
    color: int = 0
    hidden: bool = False
    low: Array | None = None
    high: Array | None = None


@dataclass(frozen=True)
class Panel:
    """Series on one axis. level: a line across, such as a bound; prefixes: numbers as 14.2 ns, not 1.42e-8 s"""

    title: str
    series: tuple[Series, ...]
    unit: str = ""
    log: bool = False
    level: float | None = None
    height: float = 1.0
    prefixes: bool = False

    @property
    def heading(self) -> str:
        return f"{self.title} [{self.unit}]" if self.unit and not self.prefixes else self.title


@dataclass(frozen=True)
class Plot(Block):
    """Curves in which one looks closely: zoom, values on hover, curves that switch off; an SVG in print.

    x: not decreasing, shared by all panels (N,); panels: from top to bottom, of relative heights
    log_x: logarithmic, and lines go on where a series has no value at an x of another
    upright: x of a line upright through all panels, such as an instant
    label: what a screen reader says; wide: alone in its line on screens of usual width, otherwise two beside each other
    """

    x: Array
    x_title: str
    panels: tuple[Panel, ...]
    label: str
    caption: str = ""
    log_x: bool = False
    wide: bool = True
    upright: float | None = None


@dataclass(frozen=True)
class Group(Block):
    """Blocks that belong together: folded as one, or beside other blocks as one.

    key: its anchor on the page, where a row links to it; unique in the report
    """

    blocks: tuple[Block, ...]
    key: str = ""


@dataclass(frozen=True)
class Section:
    """key: its anchor on the page, unique in the report; sheet: begins a new sheet in print

    folded: under these words on the page the blocks are closed until they are opened; "" where they are open
    """

    key: str
    title: str
    blocks: tuple[Block, ...]
    verdict: Verdict | None = None
    sheet: bool = False
    folded: str = ""


@dataclass(frozen=True)
class Report:
    """What a command found.

    record: makes the typed record of the JSON file; None where the command writes its file as it goes
    warnings: above all else on the page; terminals have them beside the result
    """

    title: str
    verdict: Verdict | None
    sections: tuple[Section, ...]
    record: Recorder | None = field(default=None, repr=False)
    warnings: tuple[str, ...] = ()

    @property
    def ordered(self) -> Sequence[Section]:
        """Sections without a verdict keep their places at both ends; failures come first among the others."""
        judged = [k for k, section in enumerate(self.sections) if section.verdict]
        by_state = sorted(judged, key=lambda k: FAILURES_FIRST[self.sections[k].verdict.state])  # type: ignore[union-attr]
        places = dict(zip(judged, by_state, strict=True))
        return [self.sections[places.get(k, k)] for k in range(len(self.sections))]


def with_stage(report: Report, figures: Sequence[Figure]) -> Report:
    """The report with these robots in three dimensions, in one stage; without any, the report as it is.

    It is in place of the picture of the report's robot; where there is none, or are several, at the end of the first
    section.
    """
    if not figures:
        return report
    stage = Stage(tuple(figures))
    pictures = [block for section in report.sections for block in section.blocks if isinstance(block, RobotPicture)]
    if len(pictures) != 1:
        first, *others = report.sections
        return replace(report, sections=(replace(first, blocks=(*first.blocks, stage)), *others))

    def exchanged(block: Block) -> Block:
        return stage if block is pictures[0] else block

    sections = [replace(section, blocks=tuple(map(exchanged, section.blocks))) for section in report.sections]
    return replace(report, sections=tuple(sections))


def shown(blocks: Sequence[Block], medium: Medium) -> Iterator[Block]:
    """The blocks for this medium, without tables, notes and facts that are empty."""
    for block in blocks:
        empty = any(getattr(block, name, None) == () for name in ("rows", "items", "notes", "blocks", "lines"))
        if medium in block.on and not empty:
            yield block
