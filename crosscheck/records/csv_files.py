"""Delimited text as other programs write it: usual delimiters, decimal commas, comments, with or without a header."""

from __future__ import annotations

import csv
import re
from collections import Counter
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.records.cells import as_doubles
from crosscheck.records.errors import BadRecordingFile
from crosscheck.records.findings import Finding
from crosscheck.records.table import Table
from graphdyn.layout import Array

DELIMITERS = (";", "\t", ",", " ")
"""Tried in this order: a comma may be the decimal sign of a file whose delimiter is another."""

HEAD, SAMPLED_LINES = 1 << 20, 50
"""Characters among which comments, header and the lines are found that show the delimiter."""

NUMBER = r"^-?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$"
COMMENT = re.compile(r"\s*[#%]+\s*")


def read_csv(path: Path, delimiter: str | None = None) -> Table:
    """Read delimited text. Raises BadRecordingFile where it is no table of numbers, and OSError."""
    text = _text(path)
    head = text[:HEAD].split("\n")
    n_above = next((k for k, line in enumerate(head) if line.strip() and not COMMENT.match(line)), None)
    if n_above is None:
        raise BadRecordingFile(f"{path}: the file holds no table; record at least one row")
    sample = [line for line in head[n_above:-1] if line.strip()][:SAMPLED_LINES] or [
        head[n_above]
    ]  # the last may be cut
    delimiter = delimiter or _delimiter(path, sample)
    comma = delimiter != "," and _has_decimal_comma(sample, delimiter)
    first = _cells(sample[0], delimiter)
    header = not all(_is_number(cell, comma) for cell in first)
    names = first if header else _commented_names(head[:n_above], delimiter, len(first))
    above = n_above + header
    body = text[sum(len(line) + 1 for line in head[:above]) :]
    count = body.count("\n") + (not body.endswith("\n") and body != "")
    if count == 0:
        raise BadRecordingFile(f"{path}: no line below the header; record at least one row")
    table, wrong = _parsed(path, body, delimiter, comma, len(names), above + 1)
    if 2 * len(wrong) > count:
        row, cells = next(iter(wrong.items()))
        raise BadRecordingFile(
            f"{path}: {len(wrong)} of {count} lines do not have {len(names)} cells as the first one "
            f"(line {row + above + 1} has {cells}); name the delimiter in a mapping, or repair the file"
        )
    values = np.full((count, len(names)), np.nan)
    good = np.setdiff1d(np.arange(count), list(wrong))
    texts: dict[int, dict[int, str]] = {}
    for k, column in enumerate(table.columns):
        values[good, k] = _numbers(column, comma)
        bad = np.flatnonzero(np.isnan(values[good, k]))
        texts[k] = {int(good[row]): _shown(column[int(row)].as_py()) for row in bad}
    for row in set.intersection(*({row for row, cell in cells.items() if not cell} for cells in texts.values())):
        wrong[row] = 0
    findings = _line_findings(path, wrong, len(names), count, above + 1)
    if not body.endswith("\n") and count - 1 not in wrong:
        cut = bool(np.isnan(values[-1, -1])) and not np.isnan(values[-2:-1, -1]).any()
        findings.append(_last_line(path, count - 1, above + 1, cut))
    if not any(names):
        message = "the first line holds numbers, so the columns have no names"
        findings.append(_note(path, "no-header", message, "they can be mapped by number only"))
    if comma:
        message = "the numbers have decimal commas"
        findings.append(_note(path, "decimal-comma", message, "they are read as such"))
    return Table(path, tuple(names), values, texts, above + 1, findings=tuple(findings))


def _note(path: Path, code: str, message: str, remedy: str) -> Finding:
    return Finding(code, "note", str(path), None, (), message, remedy)


def _text(path: Path) -> str:
    content = path.read_bytes()
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise BadRecordingFile(f"{path}, line {line}: not UTF-8 text; save the file as CSV in UTF-8") from error
    if "\0" in text:
        line = text[: text.index("\0")].count("\n") + 1
        raise BadRecordingFile(f"{path}, line {line}: a zero byte, so not text; save the file as CSV in UTF-8")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _delimiter(path: Path, sample: list[str]) -> str:
    """The first of the usual delimiters that cuts half of the lines alike.

    csv.Sniffer wants all lines alike, which those of dirty files are not.
    """
    for delimiter in DELIMITERS:
        cells, lines = Counter(len(_cells(line, delimiter)) for line in sample).most_common(1)[0]
        if cells > 1 and 2 * lines >= len(sample):
            return delimiter
    if 2 * sum(map(_is_number, sample)) > len(sample):  # one column
        return ","
    raise BadRecordingFile(
        f"{path}: no delimiter (semicolon, tab, comma, space) cuts half of the first {len(sample)} lines alike; "
        'name it in a mapping (delimiter = "|"), or repair the file'
    )


def _cells(line: str, delimiter: str) -> list[str]:
    if delimiter == " ":
        return line.split()
    return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))]


def _is_number(cell: str, comma: bool = False) -> bool:
    """Whether the cell is a number, a calendar time, or empty: what no header has."""
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
    """Names from the comment right above the numbers, as numpy.savetxt writes them; else none."""
    names = _cells(COMMENT.sub("", comments[-1], count=1), delimiter) if comments else []
    return names if len(names) == count and not all(map(_is_number, names)) else [""] * count


def _parsed(path: Path, body: str, delimiter: str, comma: bool, n: int, lines: int) -> tuple[Any, dict[int, int]]:
    """The Arrow table of the lines with n cells, and the rows of the others with the numbers of their cells."""
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    if delimiter == " ":
        body = re.sub(r"(?m)^ | $", "", re.sub(r"[ \t]+", " ", body))
    wrong: dict[int, int] = {}

    def skip(row: Any) -> str:
        wrong[row.number - 1] = 0 if row.text.strip() == "" else row.actual_columns
        return "skip"

    def read(types: dict[str, Any] | None) -> Any:
        wrong.clear()
        return arrow_csv.read_csv(
            pa.BufferReader(body.encode()),
            read_options=arrow_csv.ReadOptions(column_names=[str(k) for k in range(n)], use_threads=False),
            parse_options=arrow_csv.ParseOptions(
                delimiter=delimiter, ignore_empty_lines=False, invalid_row_handler=skip
            ),
            convert_options=arrow_csv.ConvertOptions(
                column_types=types, decimal_point="," if comma else ".", null_values=[""], strings_can_be_null=True
            ),
        )

    try:
        try:
            return read(None), wrong
        except pa.ArrowInvalid:  # types are inferred from the first block only
            return read({str(k): pa.string() for k in range(n)}), wrong
    except pa.ArrowInvalid as error:
        raise BadRecordingFile(f"{path}, from line {lines} on: {error}; repair the file") from error


def _numbers(column: Any, comma: bool) -> Array:
    """Doubles; seconds since the first of them where the column holds calendar times."""
    import pyarrow as pa
    from pyarrow import compute

    if pa.types.is_string(column.type):
        column = compute.replace_substring_regex(compute.utf8_trim_whitespace(column), r"^\+", "")
        column = compute.replace_substring(column, ",", ".") if comma else column
        number = compute.match_substring_regex(column, NUMBER)
        column = compute.if_else(number, column, pa.scalar(None, pa.string()))
    if not pa.types.is_timestamp(column.type):
        return as_doubles(column)
    stamps = column.cast(pa.timestamp("ns")).cast(pa.int64()).to_numpy(zero_copy_only=False)
    return np.asarray((stamps - np.nanmin(stamps)) * 1e-9, dtype=float)


def _shown(cell: Any) -> str:
    return "" if cell is None else str(cell)


def _line_findings(path: Path, wrong: dict[int, int], n: int, count: int, lines: int) -> list[Finding]:
    blank = tuple(row for row, cells in wrong.items() if cells == 0)
    cut = tuple(row for row, cells in wrong.items() if row == count - 1 and 0 < cells < n)
    others = tuple(row for row in wrong if row not in blank and row not in cut)
    findings = []
    if blank:
        message, remedy = "an empty line", "it is left out"
        findings.append(Finding("blank-line", "note", str(path), None, blank, message, remedy, lines))
    if cut:
        message, remedy = f"{wrong[cut[0]]} of {n} cells, the file breaks off", "the line is left out"
        findings.append(Finding("truncated-last-line", "warning", str(path), None, cut, message, remedy, lines))
    if others:
        message = f"{', '.join(map(str, sorted({wrong[row] for row in others})))} cells instead of {n}"
        remedy = "repair the lines, or drop them"
        findings.append(Finding("wrong-column-count", "error", str(path), None, others, message, remedy, lines))
    return findings


def _last_line(path: Path, row: int, lines: int, cut: bool) -> Finding:
    """The last line has no end: its last cell may be cut off, and is where it is no number."""
    if cut:
        message, remedy = "the file breaks off inside a number", "the line is left out"
        return Finding("truncated-last-line", "warning", str(path), None, (row,), message, remedy, lines)
    message, remedy = "the last line has no end, so its last number may be cut off", "drop it if it is"
    return Finding("unterminated-last-line", "note", str(path), None, (row,), message, remedy, lines)
