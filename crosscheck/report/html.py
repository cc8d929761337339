"""Any report as a page: one file, readable without network, script or color; with script, plots can be zoomed.

The scripts on it are known to its content security policy by their hashes; nothing is evaluated from text.
"""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import count
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from crosscheck.report.pictures.plot import plot_data, plot_picture, points_per_curve, samples_per_curve
from crosscheck.report.plain_text import printable
from crosscheck.report.report import (
    VERDICT_SYMBOLS,
    Block,
    Code,
    Column,
    Facts,
    Hover,
    Note,
    Notes,
    Picture,
    Plot,
    Prose,
    Report,
    Stage,
    Table,
    Verdict,
    shown,
)
from crosscheck.report.report import Group as BlockGroup
from crosscheck.viewing.page import file_text, policy_hash, script_hashes
from crosscheck.viewing.page import page as stage_page
from crosscheck.viewing.scene import compressed

MAX_NOTE_LENGTH = 240
"""Characters from which a note is folded."""

MAX_NOTES_PER_CODE = 3
"""Notes of one code from which they are folded together."""

MAX_CELL_LENGTH = 90
"""Characters of a cell from which the rows of its table are stacked on narrow screens."""

PACKED_FROM = 8_000
"""Characters from which a part that is closed at first is kept compressed until it is opened."""

MAX_NAME_LENGTH = 28
"""Characters from which the name in a table is cut (style.css), so that hovering has to show the whole."""

NAME_TAIL = 10
"""Characters of the end of a long name that are never cut."""

PAGE, VENDOR = Path(__file__).parent / "page", Path(__file__).parents[1] / "vendor"


def page(report: Report, command: Sequence[str], versions: dict[str, str]) -> str:
    """The page of a report. The same report, command and versions give the same characters.

    command: the arguments that made it; versions: of everything that took part
    """
    blocks = [block for section in report.sections for block in _all(section.blocks)]
    plots = [block for block in blocks if isinstance(block, Plot)]
    of_stages = script_hashes() if any(isinstance(block, Stage) for block in blocks) else []
    scripts = [
        *([file_text(VENDOR / "uPlot.iife.min.js"), file_text(PAGE / "plots.js")] if plots else []),
        file_text(PAGE / "page.js"),
    ]
    styles = [*([file_text(VENDOR / "uPlot.min.css")] if plots else []), file_text(PAGE / "style.css")]
    return (
        environment()
        .get_template("page.html")
        .render(
            report=report,
            sections=[(section, list(shown(section.blocks, "page"))) for section in report.ordered],
            contents=[section for section in report.ordered if section.title],
            styles=[Markup(style) for style in styles],
            scripts=[Markup(script) for script in scripts],
            hashes=[*map(policy_hash, scripts), *of_stages],
            command=shlex.join(command),
            versions=versions,
            key=map("p{}".format, count(1)).__next__,
            samples=samples_per_curve(plots),
            points=points_per_curve(plots),
        )
    )


def _all(blocks: Sequence[Block]) -> Iterator[Block]:
    for block in shown(blocks, "page"):
        yield block
        if isinstance(block, BlockGroup):
            yield from _all(block.blocks)


def _stage_page(stage: Stage) -> str:
    return stage_page(", ".join(figure.name for figure in stage.figures), stage.figures)


def _pack(part: str) -> str:
    return compressed(part.encode())


def _printed_folded(block: Block) -> bool:
    """Whether paper shows it although it is closed: it is never compressed, which would take a moment to undo."""
    return isinstance(block, Table | Notes | Facts)


def _kind(block: Block) -> str:
    """Name of the macro that writes a block."""
    return type(block).__name__.lower()


def _note_groups(notes: Sequence[Note]) -> list[tuple[str, list[Note], bool]]:
    """Notes by code in the order of their first, and whether the group is folded."""
    groups: dict[str, list[Note]] = {}
    for note in notes:
        groups.setdefault(note.code, []).append(note)
    return [(code, group, bool(code) and len(group) > MAX_NOTES_PER_CODE) for code, group in groups.items()]


def _hover(column: Column, value: object) -> str:
    """What a cell says where a pointer rests on it: its own words, or the whole of a name that the page cuts."""
    if isinstance(value, Hover):
        return value.more
    text = column.text(value)
    return text if column.kind == "name" and len(text) > MAX_NAME_LENGTH else ""


def _wordy(table: Table) -> bool:
    """Whether it has sentences in its cells, too wide for a narrow screen beside other columns."""
    return any(
        len(column.text(value)) > MAX_CELL_LENGTH
        for row in table.rows
        for column, value in zip(table.columns, row.cells, strict=True)
        if column.kind == "text"
    )


def _is_verdict(value: object) -> bool:
    return isinstance(value, Verdict)


def _width(block: Block) -> str:
    """Class of style.css: how much of the width of its section a block takes; others stand beside it where they fit."""
    match block:
        case Picture(wide=False):
            return "small"
        case Plot(wide=False):
            return "half"
        case Picture() | Plot() | Stage():
            return "wide"
        case Prose() | Notes() | Code():
            return "whole"
        case _:
            return "whole" if block.folded else "natural"


def _shown(value: object) -> object:
    """Every expression of the templates goes through here: it may hold names and messages of others."""
    return printable(value, keep="\n\t") if isinstance(value, str) and not isinstance(value, Markup) else value


@cache
def environment() -> Environment:
    """The templates of pages and of their parts."""
    environment = Environment(
        loader=PackageLoader("crosscheck.report", "page"),
        autoescape=True,
        finalize=_shown,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        kind=_kind,
        width=_width,
        note_groups=_note_groups,
        page_blocks=lambda blocks: list(shown(blocks, "page")),
        pack=_pack,
        zip=zip,
    )
    environment.tests.update(verdict=_is_verdict, printed_folded=_printed_folded)
    environment.globals.update(
        SYMBOLS=VERDICT_SYMBOLS,
        hover=_hover,
        wordy=_wordy,
        plot_data=plot_data,
        plot_picture=plot_picture,
        stage_page=_stage_page,
        MAX_NOTE_LENGTH=MAX_NOTE_LENGTH,
        NAME_TAIL=NAME_TAIL,
        PACKED_FROM=PACKED_FROM,
    )
    return environment
