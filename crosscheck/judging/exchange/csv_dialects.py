"""CSV as R, Excel and other programs write it: quotes, byte order marks, row names, and decimal commas."""

from __future__ import annotations

import csv
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE

from crosscheck.judging.exchange.printed_numbers import printed_number

_CELL_WITH_COMMA = re.compile(r"[-+]?\d+,\d+(?:[eE][-+]?\d+)?")
"""A number with a decimal comma."""


def plain_lines(content: bytes) -> list[str]:
    """The lines of a CSV file without quotes, row names and decimal commas, as far as these are unambiguous.

    Decimal commas are: where all rows have semicolons or all have tabs, and no cell has a decimal point.
    Row names are what stands before the column whose head is id.
    """
    utf16 = content.startswith((BOM_UTF16_LE, BOM_UTF16_BE))
    text = content.decode("utf-16" if utf16 else "utf-8-sig", errors="replace")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    used = [line for line in lines if line.strip()]
    body = used[1:] if used and not re.match(r"\s*\"?[-+.0-9]", used[0]) else used
    delimiter = next((x for x in ";\t" if body and all(x in line for line in body)), ",")
    commas = delimiter != "," and any("," in line for line in body) and not any("." in line for line in body)
    if '"' not in text and not commas and not _named(used, delimiter):
        return lines
    if '"' in text and delimiter == "," and any("," not in line for line in body):
        delimiter = " "
    rows = [_cells(line, delimiter) for line in lines]
    first = next((row for row in rows if row), [])
    shift = _row_names(first, next((row for row in rows[1:] if row), []))
    return [_line(row if row is first else row[shift:], delimiter, commas=commas) for row in rows]


def _cells(line: str, delimiter: str) -> list[str]:
    found = next(iter(csv.reader([line], delimiter=delimiter, skipinitialspace=True)), [])
    return [cell.strip() for cell in found]


def _named(used: list[str], delimiter: str) -> bool:
    return (
        bool(used) and _row_names(_cells(used[0], delimiter), _cells(used[1], delimiter) if len(used) > 1 else []) > 0
    )


def _row_names(head: list[str], row: list[str]) -> int:
    """Number of cells before the id, by the head; R's write.table leaves out the head of the row names."""
    names = [cell.lower() for cell in head]
    if "id" not in names:
        return 0
    return names.index("id") + (len(row) == len(head) + 1 and printed_number(row[-1].replace(",", ".")) is not None)


def _line(row: list[str], delimiter: str, *, commas: bool) -> str:
    if commas:
        row = [cell.replace(",", ".") if _CELL_WITH_COMMA.fullmatch(cell) else cell for cell in row]
    return f"{delimiter} ".join(row) if delimiter == "," else delimiter.join(row)
