"""The layout of a table in a text file: delimiter, decimal sign, comments above, header; found from its beginning."""

from __future__ import annotations

import csv
import re
from collections import Counter
from datetime import datetime
from pathlib import Path
from typing import NamedTuple

from crosscheck.recordings.errors import BadRecordingFile

DELIMITERS = (";", "\t", ",", " ")
"""Delimiters, in the order in which they are tried: a comma may be the decimal sign of a file with another one."""

HEAD, SAMPLED_LINES = 1 << 20, 50
"""Number of characters read to find comments and header; number of lines from which the delimiter is found."""

COMMENT = re.compile(r"\s*[#%]+\s*")


class Layout(NamedTuple):
    """Layout of a table. names: "" where there are none; above: lines before the first row, length characters long."""

    delimiter: str
    decimal_comma: bool
    names: tuple[str, ...]
    above: int
    length: int


def layout_of(path: Path, text: str, delimiter: str | None) -> Layout:
    """The layout of a file that begins with this text. Raises BadRecordingFile."""
    head = text[:HEAD].split("\n")
    n_above = next((k for k, line in enumerate(head) if line.strip() and not COMMENT.match(line)), None)
    if n_above is None:
        raise BadRecordingFile(f"{path}: the file holds no table; record at least one row")
    sample = [line for line in head[n_above:-1] if line.strip()][:SAMPLED_LINES]
    sample = sample or head[n_above : n_above + 1]  # the last line may be cut off, so it is used only if alone
    delimiter = delimiter or _delimiter(path, sample)
    comma = delimiter != "," and _has_decimal_comma(sample, delimiter)
    first = _cells(sample[0], delimiter)
    header = not all(_is_number(cell, comma) for cell in first)
    names = first if header else _commented_names(head[:n_above], delimiter, len(first))
    above = n_above + header
    return Layout(delimiter, comma, tuple(names), above, sum(len(line) + 1 for line in head[:above]))


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


def _cells(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]


def _is_number(cell: str, comma: bool = False) -> bool:
    """Whether the cell is a number, a calendar time, or empty, as no cell of a header is."""
    for reads in (float, datetime.fromisoformat):
        try:
            reads(cell.replace(",", ".") if comma else cell)
            return True
        except ValueError:
            pass
    return cell == ""


def _has_decimal_comma(sample: list[str], delimiter: str) -> bool:
    cells = [cell for line in sample[-10:] for cell in _cells(line, delimiter)]
    return any(re.fullmatch(r"[-+]?\d+,\d+([eE][-+]?\d+)?", cell) for cell in cells)


def _commented_names(comments: list[str], delimiter: str, count: int) -> list[str]:
    """Names from the comment directly above the numbers, as numpy.savetxt writes them; else empty names."""
    names = _cells(COMMENT.sub("", comments[-1], count=1), delimiter) if comments else []
    return names if len(names) == count and not all(map(_is_number, names)) else [""] * count
