"""Any report on the terminal, in a log, or in the message of an AssertionError. Imports no template and no plot."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from itertools import groupby

from rich.columns import Columns
from rich.console import Console, Group, RenderableType
from rich.measure import Measurement
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text

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

MESSAGE_WIDTH = 140
"""Characters of a line in the messages of assertions."""

LONG_HEADING = 14
"""Characters of a heading from which it may be folded above a column of numbers."""

LONG_NAME = 38
"""Characters up to which the name of a row is never folded."""

COLOURS: dict[State, str] = {"agrees": "green", "undecided": "yellow", "disagrees": "red", "plain": ""}


def renderables(report: Report, width: int) -> Iterator[RenderableType]:
    """The report from its verdict on, for lines of this many characters."""
    if report.verdict is not None:
        yield _headline(report.title, report.verdict)
    for section in report.ordered:
        yield from _section(section, width)


def as_text(report: Report, width: int = MESSAGE_WIDTH) -> str:
    """The report as plain text, for error messages and logs."""
    buffer = io.StringIO()
    console = Console(file=buffer, width=width, markup=False, highlight=False)
    for part in renderables(report, width):
        console.print(part)
    return buffer.getvalue()


def _headline(title: str, verdict: Verdict) -> Text:
    line = Text(f"{title}: ").append(verdict.words, style=f"bold {COLOURS[verdict.state]}")
    return line.append(f"\n{verdict.reason}") if verdict.reason else line


def _section(section: Section, width: int) -> Iterator[RenderableType]:
    blocks = list(_parts(shown(section.blocks, "text"), width))
    if not blocks:
        return
    if section.verdict is not None:
        yield Padding(_headline(section.title, section.verdict), (1, 0, 0, 0))
    elif section.title:
        yield Text(f"\n{section.title}", style="bold")
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
            yield Text("\n".join(lines) if lines else f"too wide for {width} characters; --json and --html have it")
        case Code() | Prose():
            yield from _title(block)
            yield Text(block.text)
        case _:  # pictures and plots are for the page
            return


def _title(block: Block) -> Iterator[Text]:
    if block.title:
        yield Text(f"\n{block.title}", style="bold")


def _note(note: Note) -> Text:
    where = f"{note.where}: " if note.where else ""
    code = f" [{note.code}]" if note.code else ""
    return Text(f"{where}{note.text}{code}", style=COLOURS[note.state] if note.state != "agrees" else "")


def _facts(block: Facts) -> RichTable:
    grid = RichTable.grid(padding=(0, 2, 0, 0))
    grid.add_column(no_wrap=True, style="dim")
    grid.add_column(overflow="fold")
    for name, said in block.items:
        grid.add_row(name, said)
    return grid


def _lines(blocks: Sequence[Lines], width: int) -> Iterator[RenderableType]:
    """Side by side where they fit; a sentence in place of those that are too wide."""
    fitting = [block for block in blocks if max(map(len, block.lines)) <= width]
    if fitting:
        parts = [Text("\n".join([*([block.title] if block.title else []), *block.lines])) for block in fitting]
        yield Padding(Columns(parts, padding=(1, 3)), (1, 0, 0, 0))
    for block in blocks:
        if block not in fitting:
            yield Text(f"{block.title}: too wide for {width} characters; --json and --html have it")


def _tables(table: Table, width: int) -> Iterator[RenderableType]:
    """One table, or several with the leading columns repeated where the line is too short for all columns."""
    yield from _title(table)
    columns = [k for k, column in enumerate(table.columns) if width >= column.from_width]
    rest, first = columns[table.repeated :], True
    while rest or first:
        taken = _fitting(table, columns[: table.repeated], rest, width)
        yield _table(table, [*columns[: table.repeated], *rest[:taken]])
        rest, first = rest[taken:], False
    if table.caption:
        yield Text(table.caption)


def _fitting(table: Table, leading: Sequence[int], rest: Sequence[int], width: int) -> int:
    """How many of the remaining columns stand beside the leading ones: all where the text in them can fold."""
    foldable = any(table.columns[k].kind in ("text", "vector") for k in rest)
    if foldable or not rest:
        return len(rest)
    console = Console(width=10 * width, file=io.StringIO())
    for count in range(len(rest), 1, -1):
        rendered = _table(table, [*leading, *rest[:count]])
        if Measurement.get(console, console.options, rendered).maximum <= width:
            return count
    return 1


def _table(table: Table, columns: Sequence[int]) -> RichTable:
    rendered = RichTable()
    for k in columns:
        column = table.columns[k]
        whole = (
            column.kind == "verdict"
            or (column.kind == "number" and len(column.heading) <= LONG_HEADING)
            or (k == columns[0] and max((len(column.text(row.cells[k])) for row in table.rows), default=0) <= LONG_NAME)
        )
        rendered.add_column(
            column.heading,
            justify="right" if column.kind == "number" else "left",
            no_wrap=whole,
            overflow="fold",
        )
    for k, row in enumerate(table.ordered):
        if row.rule and k:
            rendered.add_section()
        rendered.add_row(*(_cell(table.columns[c], row, c) for c in columns))
    return rendered


def _cell(column: Column, row: Row, k: int) -> Text:
    value = row.cells[k]
    style = COLOURS[value.state] if isinstance(value, Verdict) else ""
    return Text(column.text(value), style=style)
