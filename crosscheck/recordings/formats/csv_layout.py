"""Layout of a table in a text file, found from its beginning: delimiter, comments above, header."""

from __future__ import annotations

import csv
import re
from collections import Counter
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

from crosscheck.recordings.errors import BadRecordingFile
from urdf.document import NUMBER

DELIMITERS = (";", "\t", ",", " ")
"""Delimiters, in the order in which they are tried: a comma may be the decimal sign of a file with another one."""

HEAD_BYTES, SAMPLED_LINES = 1 << 20, 50
"""Number of characters read to find comments and header; number of lines from which the delimiter is found."""

MAX_FIRST_LINE = HEAD_BYTES // 4
"""Number of characters from which a first line without end is no line of a table."""

WITHOUT_VALUE = ("", "nan", "inf", "infinity")
"""Words in place of a number, in lower case and without a sign."""

COMMENT = re.compile(r"\s*[#%]+\s*")


class Layout(NamedTuple):
    """Layout of a table. names: "" if there are none; above: lines before the first row, length characters long."""

    delimiter: str
    names: tuple[str, ...]
    above: int
    length: int


def layout_of(path: Path, text: str, delimiter: str | None) -> Layout:
    """The layout of a file that begins with this text. Raises BadRecordingFile."""
    head = text[:HEAD_BYTES].split("\n")
    n_above = next((k for k, line in enumerate(head) if line.strip() and not COMMENT.match(line)), None)
    if n_above is None:
        raise BadRecordingFile(f"{path}: the file holds no table; record at least one row")
    if n_above == len(head) - 1 and len(text) > MAX_FIRST_LINE:
        raise BadRecordingFile(
            f"{path}, line {n_above + 1}: longer than {MAX_FIRST_LINE} characters; write one line per time"
        )
    sample = [line for line in head[n_above:-1] if line.strip()][:SAMPLED_LINES]
    sample = sample or head[n_above : n_above + 1]  # the last line may be cut off, so it is used only if alone
    delimiter = delimiter or _delimiter(path, sample)
    first = _cells(sample[0], delimiter)
    header = not all(_is_number(cell) for cell in first) and not _repeats(sample, first, delimiter)
    names = first if header else _commented_names(head[:n_above], delimiter, len(first))
    above = n_above + header
    return Layout(delimiter, tuple(names), above, sum(len(line) + 1 for line in head[:above]))


def _delimiter(path: Path, sample: list[str]) -> str:
    """The first of the usual delimiters that splits half of the lines into the same number of cells.

    csv.Sniffer needs all lines alike, which fails for files with faulty lines.
    """
    for delimiter in DELIMITERS:
        cells, lines = Counter(len(_cells(line, delimiter)) for line in sample).most_common(1)[0]
        if cells > 1 and 2 * lines >= len(sample):
            return delimiter
    if 2 * sum(map(_is_number, sample)) > len(sample):  # one column
        return ","
    raise BadRecordingFile(
        f"{path}: no delimiter (semicolon, tab, comma, space) splits half of the first {len(sample)} lines alike; "
        'name it in a mapping (delimiter = "|"), or repair the file'
    )


def cells_of_line(line: str, layout: Layout) -> list[str]:
    """The cells of a line as text."""
    return _cells(line, layout.delimiter)


def _cells(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    if '"' not in line:
        return [cell.strip() for cell in line.split(delimiter)]
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]
    except csv.Error:  # a cell longer than csv.field_size_limit: not a table with this delimiter
        return [line]


def _is_number(cell: str) -> bool:
    """Whether the cell is a number, a calendar time, or empty; a cell of a header is none of these."""
    if cell.lower().lstrip("+-") in WITHOUT_VALUE or re.fullmatch(NUMBER, cell.replace(",", ".")):
        return True
    try:
        datetime.fromisoformat(cell)
    except ValueError:
        return False
    return True


def _repeats(sample: list[str], first: list[str], delimiter: str) -> bool:
    """Whether the first line is a row like the second one: numbers, and words that are the same in both."""
    second = _cells(sample[1], delimiter) if len(sample) > 1 else []
    numbers = [_is_number(cell) for cell in first]
    return any(numbers) and [cell for cell, number in zip(first, numbers, strict=True) if not number] == [
        cell for cell, number in zip(second, numbers, strict=False) if not number
    ]


def _commented_names(comments: list[str], delimiter: str, count: int) -> list[str]:
    """Names from the comment directly above the numbers, as numpy.savetxt writes them; otherwise empty names."""
    names = _cells(COMMENT.sub("", comments[-1], count=1), delimiter) if comments else []
    return names if len(names) == count and not all(map(_is_number, names)) else [""] * count
