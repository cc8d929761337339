"""Any report on the terminal, in a log, or in the message of an AssertionError. Imports no template and no plot."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from math import ceil
from typing import Any

from rich import box
from rich.cells import cell_len
from rich.columns import Columns
from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text

from crosscheck.report.plain_text import printable
from crosscheck.report.report import (
    Block,
    CharacterPicture,
    Code,
    Column,
    Facts,
    Lines,
    Note,
    Notes,
    Prose,
    Report,
    Row,
    Section,
    State,
    Table,
    Verdict,
    shown,
)
from crosscheck.report.report import Group as BlockGroup

MAX_NAME_WIDTH, MIN_NAME_WIDTH = 38, 20
"""Characters up to which the name of a row is never folded, and those that longer ones have at least."""

WORD = re.compile(r"[^ _]+[ _]*")
"""Pattern of a word of a heading; a name can be folded behind an underscore."""

COMPACT_STYLE: dict[str, Any] = {"box": box.SIMPLE_HEAD, "show_edge": False, "padding": 0}
"""Style of compact tables."""

MESSAGE_WIDTH = 140
"""Characters of a line in the messages of assertions."""

VERDICT_COLORS: dict[State, str] = {"agrees": "green", "undecided": "yellow", "disagrees": "red", "plain": ""}


def renderables(report: Report, width: int) -> Iterator[RenderableType]:
    """The report, for lines of this many characters, from its verdict on. One with a table ends with it, too."""
    if report.verdict is not None:
        yield _headline(report.title, report.verdict)
    parts = [part for section in report.ordered for part in _section(section, width)]
    yield from parts
    if report.verdict is not None and (len(report.ordered) > 1 or any(isinstance(x, RichTable) for x in parts)):
        yield Padding(_closing(report.title, report.verdict, width), (1, 0, 0, 0), expand=False)


def as_text(report: Report, width: int = MESSAGE_WIDTH) -> str:
    """The report as plain text, for error messages and logs."""
    buffer = io.StringIO()
    console = Console(file=buffer, width=width, markup=False, highlight=False)
    for part in renderables(report, width):
        console.print(part)
    return buffer.getvalue()


def _text(*lines: str, style: str = "") -> Text:
    """Every text of a report goes through here: it may hold names and messages of others."""
    return Text("\n".join(map(printable, lines)), style=style)


def _headline(title: str, verdict: Verdict) -> Text:
    line = _text(f"{title}: ").append_text(_text(verdict.words, style=f"bold {VERDICT_COLORS[verdict.state]}"))
    return line.append_text(_text("", verdict.reason)) if verdict.reason else line


def _closing(title: str, verdict: Verdict, width: int) -> Text:
    """The headline in one line, with the reason, or its first sentence, where there is room for it."""
    line = _headline(title, replace(verdict, reason=""))
    whole = verdict.reason.replace("\n", " ")
    first, sentence, _ = whole.partition(". ")
    for said in (whole, first + sentence.rstrip()) if whole else ():
        reason = _text(f". {said}")
        if line.cell_len + reason.cell_len <= width:
            return line.append_text(reason)
    return line


def _section(section: Section, width: int) -> Iterator[RenderableType]:
    blocks = list(_parts(shown(section.blocks, "text"), width))
    if not blocks:
        return
    if section.verdict is not None:
        yield Padding(_headline(section.title, section.verdict), (1, 0, 0, 0))
    elif section.title:
        yield _text("", section.title, style="bold")
    yield from blocks


def _parts(blocks: Iterator[Block], width: int) -> Iterator[RenderableType]:
    for side_by_side, run in groupby(blocks, lambda block: isinstance(block, Lines)):
        if side_by_side:
            yield from _lines([block for block in run if isinstance(block, Lines)], width)
        else:
            for block in run:
                yield from _block(block, width)


def _block(block: Block, width: int) -> Iterator[RenderableType]:
    match block:
        case Table():
            yield from _tables(block, width)
        case BlockGroup():
            yield from _title(block)
            yield from _parts(shown(block.blocks, "text"), width)
        case Facts():
            yield from _title(block)
            yield _facts(block)
        case Notes():
            yield from _title(block)
            yield Group(*map(_note, block.notes))
        case CharacterPicture():
            yield from _title(block)
            lines = block.draw(width)
            yield _text(*(lines or [f"too wide for {width} characters; --json and --html have it"]))
            if lines and block.caption:
                yield _text(block.caption)
        case Code():
            yield from _title(block)
            yield _text(*block.text.split("\n"))
        case Prose():
            yield from _title(block)
            yield _text(*([""] if block.apart else []), block.text)
        case _:  # pictures and plots are for the page
            return


def _title(block: Block) -> Iterator[Text]:
    if block.title:
        yield _text("", block.title, style="bold")


def _note(note: Note) -> Text:
    where = f"{note.where}: " if note.where else ""
    code = f" [{note.code}]" if note.code else ""
    return _text(f"{where}{note.text}{code}", style=VERDICT_COLORS[note.state] if note.state != "agrees" else "")


def _facts(block: Facts) -> RichTable:
    grid = RichTable.grid(padding=(0, 2, 0, 0))
    grid.add_column(no_wrap=True, style="dim")
    grid.add_column(overflow="fold")
    for name, said in block.items:
        grid.add_row(_text(name), _text(said))
    return grid


def _lines(blocks: Sequence[Lines], width: int) -> Iterator[RenderableType]:
    """Side by side where they fit; a sentence in place of those that are too wide."""
    fitting = [block for block in blocks if max(map(len, block.lines)) <= width]
    if fitting:
        parts = [_text(*([block.title] if block.title else []), *block.lines) for block in fitting]
        yield Padding(Columns(parts, padding=(1, 3)), (1, 0, 0, 0))
    for block in blocks:
        if block not in fitting:
            yield _text(f"{block.title}: too wide for {width} characters; --json and --html have it")


def _tables(table: Table, width: int) -> Iterator[RenderableType]:
    """One table, or several with the leading columns repeated where the line is too short for all columns."""
    yield from _title(table)
    if table.compact and not table.title:
        yield Text()
    columns = [
        _Column(column, [_cell(column, row, k).plain for row in table.rows], k)
        for k, column in enumerate(table.columns)
        if width >= column.from_width
    ]
    leading, rest, first = columns[: table.repeated], columns[table.repeated :], True
    while rest or first:
        taken = _fitting(leading, rest, width, table.compact)
        yield _table(table, [*leading, *rest[:taken]], width)
        rest, first = rest[taken:], False
    if table.caption:
        yield _text(table.caption)


@dataclass(frozen=True)
class _Column:
    """A column with the texts of its cells, in the order of table.rows, and its place in table.columns."""

    column: Column
    cells: Sequence[str]
    place: int

    @property
    def wraps(self) -> bool:
        return self.column.kind not in ("number", "verdict")

    @property
    def natural(self) -> int:
        """Characters in which nothing is wrapped."""
        return max(map(cell_len, [self.column.heading, *self.cells]))

    @property
    def least(self) -> int:
        """Characters that suffice when the heading is folded, and text wrapped."""
        words = [word.rstrip() for word in WORD.findall(self.column.heading)]
        if self.column.kind == "name":
            longest = max(map(cell_len, self.cells), default=0)
            return max([*map(cell_len, words), longest if longest <= MAX_NAME_WIDTH else MIN_NAME_WIDTH])
        if not self.wraps:
            return max(map(cell_len, [*words, *self.cells]), default=0)
        said = [word[:MAX_NAME_WIDTH] for cell in self.cells for word in cell.split()]  # a path is folded inside
        return max(map(cell_len, [*words, *said]), default=0)

    @property
    def wanted(self) -> int:
        """Characters beyond which nothing is gained when headings are folded."""
        return max(self.least, *map(cell_len, self.cells), 0) if self.wraps else self.least

    def folded_heading(self) -> list[str]:
        lines = [""]
        for word in WORD.findall(self.column.heading):
            if cell_len((lines[-1] + word).rstrip()) > self.wanted:
                lines.append("")
            lines[-1] += word
        return [line.rstrip() for line in lines]


def _fitting(leading: Sequence[_Column], rest: Sequence[_Column], width: int, compact: bool) -> int:
    """How many of the remaining columns stand beside the leading ones; about as many in each of several tables."""
    if not rest:
        return 0
    counts = range(len(rest), 1, -1)
    fitting = (
        k for k in counts if sum(c.least for c in [*leading, *rest[:k]]) <= _room(len(leading) + k, width, compact)
    )
    most = next(fitting, 1)
    return ceil(len(rest) / ceil(len(rest) / most))


def _room(columns: int, width: int, compact: bool) -> int:
    """Characters of a line without the borders of a table, or the spaces between the columns of a compact one."""
    return width - columns if compact else width - 3 * columns - 1


def _table(table: Table, columns: Sequence[_Column], width: int) -> RichTable:
    room = _room(len(columns), width, table.compact)
    narrow = sum(column.natural for column in columns) > room
    widths = _shared(columns, room) if narrow else [None] * len(columns)
    rendered = RichTable(**(COMPACT_STYLE if table.compact else {}))
    for column, characters in zip(columns, widths, strict=True):
        rendered.add_column(
            _text(*(column.folded_heading() if narrow else [column.column.heading])),
            justify="right" if column.column.kind == "number" else "left",
            no_wrap=not column.wraps,
            overflow="fold",
            width=characters,
        )
    for k, row in enumerate(table.ordered):
        if row.rule and k:
            rendered.add_section()
        rendered.add_row(*(_cell(table.columns[column.place], row, column.place) for column in columns))
    return rendered


def _shared(columns: Sequence[_Column], room: int) -> list[int | None]:
    """Widths: the least ones, and what is left over for those columns that can use it, the modest first."""
    widths: list[int | None] = [column.least for column in columns]
    spare = max(0, room - sum(column.least for column in columns))
    by_want = sorted(range(len(columns)), key=lambda k: columns[k].wanted - columns[k].least)
    for waiting, k in zip(range(len(columns), 0, -1), by_want, strict=True):
        more = min(columns[k].wanted - columns[k].least, spare // waiting)
        widths[k] = columns[k].least + more
        spare -= more
    return widths


def _cell(column: Column, row: Row, k: int) -> Text:
    value = row.cells[k]
    style = VERDICT_COLORS[value.state] if isinstance(value, Verdict) else ""
    return _text(*column.text(value).split("\n"), style=style)  # inside its frame a cell may have lines
