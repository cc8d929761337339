"""Decimal sign of the numbers of a text file: a point or a comma, never a guess.

A cell such as 1.677 is a decimal or, where the point separates thousands, 1677. Other cells tell: 0.5, 12.25 and
1234.567 have no thousands. A file that does not tell is refused until a mapping does.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crosscheck.recordings.errors import BadRecordingFile, quoted
from crosscheck.recordings.formats.csv_layout import SAMPLED_LINES, Layout, cells_of_line

SIGNS = {".": "point", ",": "comma"}


def other(sign: str) -> str:
    """The sign that is not the decimal one, which may separate thousands."""
    return "," if sign == "." else "."


def separated(sign: str) -> str:
    """Pattern of a number with this decimal sign."""
    return rf"[-+]?(?:\d+[{sign}]\d*|[{sign}]\d+)(?:[eE][-+]?\d+)?"


def doubtful(sign: str) -> str:
    """Pattern of a cell that is a decimal or, if the sign separates thousands, an integer."""
    return rf"[-+]?[1-9]\d{{0,2}}[{sign}]\d{{3}}"


def with_thousands(sign: str) -> str:
    """Pattern of a number with this decimal sign, or none, and the other one between thousands."""
    return rf"^[-+]?[1-9]\d{{0,2}}(?:[{other(sign)}]\d{{3}})+(?:[{sign}]\d*)?$"


SMALL_INTEGER, LARGE_INTEGER = r"^[-+]?0*[1-9]\d{0,2}$", r"^[-+]?\d{4,}$"
"""Integers other than 0 that have no thousands; integers whose thousands nothing separates."""


@dataclass
class ColumnSigns:
    """What the cells of one column say about its decimal sign.

    doubtful, row: the first cell that may have thousands, "" without one, and its row; integer: the first integer
    told: whether a cell cannot have thousands, or has them without a sign
    """

    sign: str
    doubtful: str = ""
    row: int = 0
    integer: str = ""
    told: bool = False
    rows: int = 0

    def add(self, texts: Any) -> None:
        """Further cells of the column (Arrow)."""
        from pyarrow import compute

        texts = compute.utf8_trim_whitespace(texts)

        def found(pattern: str) -> Any:
            return compute.fill_null(compute.match_substring_regex(texts, pattern), False)

        unsure, small = found(f"^{doubtful(self.sign)}$"), found(SMALL_INTEGER)
        others = compute.or_(compute.and_not(found(f"^{separated(self.sign)}$"), unsure), found(LARGE_INTEGER))
        self.told = self.told or bool(compute.any(others).as_py())
        first, integer = (compute.index(cells, True).as_py() for cells in (unsure, small))
        if first >= 0 and not self.doubtful:
            self.doubtful, self.row = texts[first].as_py(), self.rows + first
        if integer >= 0 and not self.integer:
            self.integer = texts[integer].as_py()
        self.rows += len(texts)

    @property
    def problem(self) -> str:
        """Why the column may have thousands; empty if it has none."""
        if self.told or not (self.doubtful and self.integer):
            return ""
        kinds = f"is a decimal, or the {SIGNS[self.sign]} separates thousands"
        return f"{kinds}; {quoted(self.integer)} in the same column has no {SIGNS[self.sign]}"


@dataclass(frozen=True, eq=False)
class DecimalSigns:
    """Search for decimal signs in a file.

    path: the file; layout: its layout; body: its rows
    """

    path: Path
    layout: Layout
    body: bytes | memoryview

    def sign(self) -> str:
        """The decimal sign, a point where no number has one. Raises BadRecordingFile if the file does not tell."""
        first = {sign: cell for sign in SIGNS if (cell := self._first(sign, separated(sign)))}
        if len(first) == 2:
            place, text = self._place(first[","]), quoted(first[","][1].decode())
            raise self._refused(first["."], f"has a point, and {text} ({place}) a comma")
        for sign in SIGNS:
            whole = rf"[-+]?[1-9]\d{{0,2}}(?:[{other(sign)}]\d{{3}})+[{sign}]\d+"
            if cell := self._first(",", whole):
                raise self._refused(cell, "has both a point and a comma")
        for sign, cell in first.items():
            certain = sign == "." and self.layout.delimiter == ","
            if not certain and self._first(sign, rf"(?!{doubtful(sign)}{self._end}){separated(sign)}") is None:
                raise self._refused(cell, f"is a decimal, or the {SIGNS[sign]} separates thousands; no cell tells")
        return next(iter(first), ".")

    def undecided(self, sign: str) -> list[int]:
        """The columns, from 0, whose first cells do not tell that the sign is a decimal one."""
        lines = bytes(self.body[: 1 << 20]).decode(errors="ignore").split("\n", SAMPLED_LINES)[:SAMPLED_LINES]
        rows = [cells_of_line(line, self.layout) for line in lines]
        told = re.compile(rf"(?!{doubtful(sign)}$){separated(sign)}$")
        decided = {k for row in rows for k, cell in enumerate(row) if told.match(cell)}
        return [k for k in range(len(self.layout.names)) if k not in decided]

    def check_column(self, number: int, texts: Any, sign: str) -> None:
        """Raise BadRecordingFile for a column (Arrow) of integers and of cells that may have thousands."""
        column = ColumnSigns(sign)
        column.add(texts)
        if column.problem:
            same = self._cells(sign, re.escape(column.doubtful))
            raise self._refused(next(cell for cell in same if self._column(cell) == number), column.problem)

    @property
    def _end(self) -> str:
        return rf'[ \t]*(?:[\n"{re.escape(self.layout.delimiter)}]|\Z)'

    def _cells(self, sign: str, pattern: str) -> Iterator[re.Match[bytes]]:
        """Matches of a pattern with whole cells; where the sign is the delimiter, with cells in quotes."""
        before = rf"[\n{re.escape(self.layout.delimiter)}]"
        quote = rf'(?<={before}")|(?<=\A")'
        begin, end = (quote, '[ \t]*"') if sign == self.layout.delimiter else (rf"\A|(?<={before})|{quote}", self._end)
        return re.finditer(rf"(?:{begin})[ \t]*({pattern})(?={end})".encode(), self.body)

    def _first(self, sign: str, pattern: str) -> re.Match[bytes] | None:
        needed = '"' if sign == self.layout.delimiter else re.escape(sign)
        if re.search(needed.encode(), self.body) is None:  # a hundred times faster than the pattern
            return None
        return next(self._cells(sign, pattern), None)

    def _column(self, cell: re.Match[bytes]) -> int:
        """The number of the column of a cell, from 0."""
        above = bytes(self.body[: cell.start(1)]).rfind(b"\n") + 1
        return len(cells_of_line(bytes(self.body[above : cell.end(1)]).decode(), self.layout)) - 1

    def _place(self, cell: re.Match[bytes]) -> str:
        line = bytes(self.body[: cell.start(1)]).count(b"\n") + self.layout.above + 1
        number = self._column(cell)
        name = self.layout.names[number] if number < len(self.layout.names) else ""
        return f"line {line}, column {quoted(name) if name else number + 1}"

    def _refused(self, cell: re.Match[bytes], message: str) -> BadRecordingFile:
        return refused(f"{self.path}, {self._place(cell)}", cell[1].decode(), message)


def refused(place: str, cell: str, message: str) -> BadRecordingFile:
    """The error of a cell that is not certain."""
    remedy = 'say which in a mapping: decimal = "." or decimal = ",", and the other sign separates thousands'
    return BadRecordingFile(f"{place}: {quoted(cell)} {message}; {remedy}")


def with_points(texts: Any, sign: str, grouped: bool) -> Any:
    """An Arrow column of texts with points as decimal signs; null for numbers with another one than this.

    grouped: whether the other sign separates thousands
    """
    import pyarrow as pa
    from pyarrow import compute

    if grouped:
        found = compute.match_substring_regex(texts, with_thousands(sign))
        texts = compute.if_else(found, compute.replace_substring(texts, other(sign), ""), texts)
    if sign == ".":
        return texts
    pointed = compute.match_substring_regex(texts, rf"^\s*{separated('.')}\s*$")
    return compute.if_else(pointed, pa.scalar(None, texts.type), compute.replace_substring(texts, ",", "."))
