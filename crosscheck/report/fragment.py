"""The beginning of a report as a piece of HTML, for notebooks: verdict, first section and picture, in few rows.

It needs no script. Its colors come from those of the text around it, so that it is readable on light and dark ground.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import count
from pathlib import Path

from markupsafe import Markup

from crosscheck.report.html import PAGE, environment
from crosscheck.report.pictures.plot import plot_picture
from crosscheck.report.report import (
    FAILURES_FIRST,
    Block,
    Code,
    Group,
    Notes,
    Picture,
    Plot,
    Prose,
    Report,
    Stage,
    Table,
    shown,
)
from crosscheck.viewing.page import file_text

MAX_FRAGMENT_ROWS = 10
"""Rows of a table, and notes, that are shown."""

POINTS_PER_CURVE = 300
"""Points of a drawn curve, each with two values."""

HEADING = re.compile(r"<h\d>([^<]*)</h\d>")
"""Headings of blocks, which are paragraphs here: the headings of a notebook are its own."""

_numbers = count(1)
"""Numbers of the fragments of this process: ids of a notebook must differ between its cells."""


def fragment(report: Report) -> str:
    """Verdict and first section of a report with its first picture; what is folded on the page is left out."""
    number = next(_numbers)
    html = (
        environment()
        .get_template("fragment.html")
        .render(
            report=report,
            PACKED_FROM=math.inf,  # nothing here needs a script
            shown=list(_beginning(report)),
            style=Markup(file_text(Path(PAGE) / "fragment.css")),
            key=map(f"graphdyn{number}-{{}}".format, count(1)).__next__,
        )
    )
    return HEADING.sub(r'<p class="subtitle">\1</p>', html)


def _beginning(report: Report) -> Iterator[Block]:
    """The blocks of the first section that has any; before them the first picture, where they have none."""
    sections = [blocks for section in report.ordered if (blocks := list(_short(section.blocks)))]
    first = sections[0] if sections else []
    if not any(map(_has_picture, first)):
        yield from [picture for blocks in sections for picture in _pictures(blocks)][:1]
    yield from first


def _has_picture(block: Block) -> bool:
    return bool(_pictures([block]))


def _pictures(blocks: Sequence[Block]) -> list[Block]:
    found: list[Block] = []
    for block in blocks:
        found += _pictures(block.blocks) if isinstance(block, Group) else [block] if isinstance(block, Picture) else []
    return found


def _short(blocks: Sequence[Block]) -> Iterator[Block]:
    """What the page shows unfolded: few rows of tables and notes, curves as pictures, no stages."""
    for block in shown(blocks, "page"):
        match block:
            case Block(folded=True) | Stage() | Code():
                continue
            case Group():
                yield replace(block, blocks=tuple(_short(block.blocks)), key="")
            case Plot():
                draw = partial(plot_picture, plot=block, points=POINTS_PER_CURVE)
                yield Picture(draw, block.caption, title=block.title)
            case Table() if len(block.rows) > MAX_FRAGMENT_ROWS:
                rows = sorted(block.rows, key=lambda row: FAILURES_FIRST[row.state])[:MAX_FRAGMENT_ROWS]
                first = tuple(replace(row, link=None) for row in rows)
                more = f"{MAX_FRAGMENT_ROWS} of {len(block.rows)} rows"
                yield replace(block, rows=first, caption=f"{block.caption}; {more}" if block.caption else more)
            case Table():
                yield replace(block, rows=tuple(replace(row, link=None) for row in block.rows))
            case Notes() if len(block.notes) > MAX_FRAGMENT_ROWS:
                yield replace(block, notes=block.notes[:MAX_FRAGMENT_ROWS])
                yield Prose(f"… {len(block.notes) - MAX_FRAGMENT_ROWS} more", soft=True)
            case _:
                yield block
