"""Delimited text from other programs: usual delimiters, decimal commas, comments, with or without a header.

This includes joint states as `ros2 topic echo --csv` prints them, without a header and with the names in every line.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.recordings.arrow import check_arrow
from crosscheck.recordings.errors import BadRecordingFile, RecordingFinding, noted, quoted
from crosscheck.recordings.formats.csv_layout import HEAD_BYTES, Layout, cells_of_line, layout_of
from crosscheck.recordings.formats.decimal_signs import ColumnSigns, DecimalSigns, refused, with_points
from crosscheck.recordings.formats.format import Format, content_of
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.table import (
    LONG_INTEGER_PATTERN,
    MAX_EXACT_INTEGER,
    Cells,
    RecordedTable,
    cells_of_column,
    in_words,
)
from crosscheck.recordings.virtual import virtual_recording_document
from graphdyn.errors import counted


def read_text(path: Path, mapping: ColumnMapping | None, _joints: tuple[str, ...] | None) -> RecordedTable:
    """The table of a text file; lines of `ros2 topic echo --csv` get names. Raises BadRecordingFile, OSError."""
    table = read_csv(path, mapping.delimiter if mapping else None, mapping.decimal if mapping else None)
    return table if table.has_names or mapping else named(table)


def read_csv(path: Path, delimiter: str | None = None, decimal: str | None = None) -> RecordedTable:
    """Read delimited text. delimiter, decimal: those of a mapping, None for what the file shows.

    Raises BadRecordingFile if it is not a table of numbers, and OSError.
    """
    check_arrow(path)
    content = content_of(path)
    head = content[:HEAD_BYTES].decode(errors="ignore")  # the last character may be cut off
    layout = layout_of(path, head, delimiter)
    body = memoryview(content)[len(head[: layout.length].encode()) :]
    ends = content.endswith(b"\n")
    count = content.count(b"\n") - layout.above + (not ends)
    if not body:
        raise BadRecordingFile(f"{path}: no line below the header; record at least one row")
    n, lines = len(layout.names), layout.above + 1
    signs = DecimalSigns(path, layout, body)
    sign = decimal or signs.sign()
    parse = _parser(path, body, layout, sign)
    table, wrong = parse(())
    if table.num_rows + len(wrong) != count:
        raise BadRecordingFile(
            f"{path}: {counted(table.num_rows + len(wrong), 'row')} in {counted(count, 'line')}, so a quotation mark "
            "is not closed; remove it"
        )
    if 2 * len(wrong) > count:
        row, cells = next(iter(wrong.items()))
        raise BadRecordingFile(
            f"{path}: {len(wrong)} of {count} lines do not have {counted(n, 'cell')} like the first one "
            f"(line {row + lines} has {cells}); name the delimiter in a mapping, or repair the file"
        )
    if decimal is None:
        _check_signs(signs, table, parse, sign)
    good = np.delete(np.arange(count), list(wrong))
    columns: list[Cells] = []
    texts: dict[int, dict[int, str]] = {}
    for k, column in enumerate(table.columns):
        read = _cells(column, sign, decimal is not None)
        unread = np.flatnonzero(np.isnan(read.values)).tolist()
        texts[k] = {int(good[row]): str(column[row].as_py() or "") for row in unread}
        values = np.full(count, np.nan)
        values[good] = read.values
        columns.append(read._replace(values=values))
    for row in set.intersection(*({row for row, cell in cells.items() if not cell} for cells in texts.values())):
        wrong[row] = 0
    findings, file = list(_line_findings(str(path), wrong, n, count, lines)), str(path)
    if not ends and count - 1 not in wrong:
        last = columns[-1].values
        cut = bool(np.isnan(last[-1])) and not np.isnan(last[-2:-1]).any()
        findings.append(_last_line(file, count - 1, lines, cut))
    if any(re.fullmatch(r"-?\d+\.\d+", name) for name in layout.names):
        message = "the first line is taken for names, though it has decimals"
        remedy = "if it is a row, write names above"
        findings.append(RecordingFinding("header-of-numbers", "warning", file, None, (), message, remedy))
    if not any(layout.names):
        message = "the first line holds numbers, so the columns have no names"
        findings.append(noted(file, "no-header", message, "they can be mapped by number only"))
    if sign == ",":
        findings.append(noted(file, "decimal-comma", "the numbers have decimal commas", "they are read with them"))
    return RecordedTable.of(path, layout.names, columns, texts=texts, lines=lines, findings=tuple(findings))


Parser = Callable[[Collection[int]], tuple[Any, dict[int, int]]]


def _parser(path: Path, body: memoryview | bytes, layout: Layout, sign: str) -> Parser:
    """Reader of some columns as texts, and of all with the types that they seem to have if none is given.

    It returns the Arrow table of the lines with n cells; for the other lines, by row, their number of cells.
    """
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    if layout.delimiter == " ":
        body = re.sub(rb"(?m)^ | $", b"", re.sub(rb"[ \t]+", b" ", body))
    names = [str(k) for k in range(len(layout.names))]
    wrong: dict[int, int] = {}

    def skip(row: Any) -> str:
        wrong[row.number - 1] = 0 if row.text.strip() == "" else row.actual_columns
        return "skip"

    def read(types: dict[str, Any] | None, wanted: list[str] | None = None) -> Any:
        wrong.clear()
        return arrow_csv.read_csv(
            pa.BufferReader(body),
            read_options=arrow_csv.ReadOptions(column_names=names, use_threads=False),
            parse_options=arrow_csv.ParseOptions(
                delimiter=layout.delimiter, ignore_empty_lines=False, invalid_row_handler=skip
            ),
            convert_options=arrow_csv.ConvertOptions(
                column_types=types,
                include_columns=wanted,
                decimal_point=sign,
                null_values=[""],
                strings_can_be_null=True,
                true_values=[],  # words, not numbers
                false_values=[],
            ),
        )

    def parsed(texts: Collection[int]) -> tuple[Any, dict[int, int]]:
        try:
            try:
                if texts:
                    return read(dict.fromkeys(map(str, texts), pa.string()), [str(k) for k in texts]), wrong
                table = read(None)
                large = [name for name in names if _beyond_doubles(table.column(name))]
                return read(dict.fromkeys(large, pa.string())) if large else table, wrong
            except pa.ArrowInvalid:  # types are inferred from the first block only
                return read(dict.fromkeys(names, pa.string())), wrong
        except pa.ArrowInvalid as error:
            raise BadRecordingFile(f"{path}, from line {layout.above + 1} on: {error}; repair the file") from error

    return parsed


def _check_signs(signs: DecimalSigns, table: Any, parse: Parser, sign: str) -> None:
    """Raise BadRecordingFile for a column of numbers whose signs may separate thousands."""
    import pyarrow as pa

    columns = {k: table.column(k) for k in signs.undecided(sign)}
    numbers = [k for k, column in columns.items() if pa.types.is_floating(column.type)]
    texts = {k: column for k, column in columns.items() if pa.types.is_string(column.type)}
    if numbers:
        texts |= dict(zip(numbers, parse(numbers)[0].columns, strict=True))
    for k, column in texts.items():
        signs.check_column(k, column, sign)


def _beyond_doubles(column: Any) -> bool:
    """Whether a column that Arrow reads as doubles may have integers with more digits, such as unsigned 64-bit ones."""
    import pyarrow as pa
    from pyarrow import compute

    if not pa.types.is_floating(column.type):
        return False
    extremes = compute.min_max(column.filter(compute.is_finite(column))).as_py().values()
    return any(value is not None and abs(value) > MAX_EXACT_INTEGER for value in extremes)


def _cells(column: Any, sign: str, grouped: bool) -> Cells:
    """A column of numbers, texts or times, as inferred from a text file.

    sign: the decimal one; grouped: whether the other one separates thousands
    """
    import pyarrow as pa

    if pa.types.is_string(column.type):
        column = with_points(column, sign, grouped)
    cells = cells_of_column(column)
    assert isinstance(cells, Cells)  # Arrow finds nothing else in text
    return cells


def _line_findings(file: str, wrong: dict[int, int], n: int, count: int, lines: int) -> Iterator[RecordingFinding]:
    blank = tuple(row for row, cells in wrong.items() if cells == 0)
    cut = tuple(row for row, cells in wrong.items() if row == count - 1 and 0 < cells < n)
    others = tuple(row for row in wrong if row not in blank and row not in cut)
    if blank:
        yield RecordingFinding("blank-line", "note", file, None, blank, "an empty line", "it is left out", lines)
    if cut:
        message, remedy = f"{wrong[cut[0]]} of {n} cells, the file is cut off", "the line is left out"
        yield RecordingFinding("truncated-last-line", "warning", file, None, cut, message, remedy, lines)
    if others:
        message = f"{', '.join(map(str, sorted({wrong[row] for row in others})))} cells instead of {n}"
        remedy = "repair the lines, or drop them"
        yield RecordingFinding("wrong-column-count", "error", file, None, others, message, remedy, lines)


def _last_line(file: str, row: int, lines: int, cut: bool) -> RecordingFinding:
    """The finding on a last line without line end: its last cell may be cut off, and is if it is not a number."""
    if cut:
        message, remedy = "the file is cut off inside a number", "the line is left out"
        return RecordingFinding("truncated-last-line", "warning", file, None, (row,), message, remedy, lines)
    message, remedy = "the last line has no line end, so its last number may be cut off", "drop it if it is"
    return RecordingFinding("unterminated-last-line", "note", file, None, (row,), message, remedy, lines)


BATCH_BYTES = 1 << 20
"""Size of the part of a CSV file that is parsed at once [bytes]."""


def batches_of_csv(path: Path, mapping: ColumnMapping | None, _rows: int) -> tuple[tuple[str, ...], Iterable[Any]]:
    """The names of the columns, and batches of some thousand rows. Raises BadRecordingFile."""
    import pyarrow as pa
    from pyarrow import csv

    def opened() -> Any:
        return pa.input_stream(str(path), compression="gzip" if path.suffix.lower() == ".gz" else None)

    with opened() as file:
        head = file.read(HEAD_BYTES).decode("utf-8-sig", errors="ignore")
    head = head.replace("\r\n", "\n").replace("\r", "\n")
    layout = layout_of(path, head, mapping.delimiter if mapping else None)
    if layout.delimiter == " ":
        raise BadRecordingFile(f"{path}: columns between spaces are not streamed; separate them by commas")
    given = mapping.decimal if mapping else None
    signs = DecimalSigns(path, layout, head[layout.length :].encode())
    sign = given or signs.sign()
    types = _types(layout, head)
    texts = range(len(layout.names)) if given else signs.undecided(sign)
    texts = [k for k in texts if types.get(str(k)) == "float64"]
    reader = csv.open_csv(
        opened(),
        read_options=csv.ReadOptions(
            column_names=[str(k) for k in range(len(layout.names))], skip_rows=layout.above, block_size=BATCH_BYTES
        ),
        parse_options=csv.ParseOptions(delimiter=layout.delimiter),
        convert_options=csv.ConvertOptions(
            column_types=types | {str(k): "string" for k in texts},
            decimal_point=sign,
            true_values=[],
            false_values=[],
        ),
    )
    return layout.names, _with_points(reader, signs, texts, sign, given)


def _with_points(
    batches: Iterable[Any], signs: DecimalSigns, texts: Sequence[int], sign: str, given: str | None
) -> Iterator[Any]:
    """The batches, with numbers for texts in the columns (texts) whose signs are not certain before they are read.

    Raises BadRecordingFile for a column of numbers whose signs may separate thousands, if no sign is given.
    """
    import pyarrow as pa
    from pyarrow import compute

    columns = {k: ColumnSigns(sign) for k in texts}
    for batch in batches:
        arrays = batch.columns
        for k, column in columns.items():
            column.add(arrays[k])
            if column.problem and given is None:
                name = signs.layout.names[k]
                place = f"{signs.path}, row {column.row}, column {quoted(name) if name else k + 1}"
                raise refused(place, column.doubtful, column.problem)
            numbers = compute.utf8_trim_whitespace(with_points(arrays[k], sign, given is not None))
            arrays[k] = numbers.cast(pa.float64())
        yield pa.record_batch(arrays, names=batch.schema.names)


def _types(layout: Layout, head: str) -> dict[str, str]:
    """Types of the columns by the first row: doubles, or integers with all digits; calendar times are inferred."""
    first = cells_of_line(next((line for line in head[layout.length :].split("\n") if line.strip()), ""), layout)
    types = {}
    for k, cell in enumerate(first):
        if re.match(LONG_INTEGER_PATTERN, cell):
            types[str(k)] = "int64" if int(cell) < 2**63 else "uint64"
        elif re.fullmatch(r"[-+.,0-9eE]*", cell):
            types[str(k)] = "float64"
    return types


STAMP_FIELDS = ("header.stamp.sec", "header.stamp.nanosec", "header.frame_id")
FIELDS = ("position", "velocity", "effort")


def named(table: RecordedTable) -> RecordedTable:
    """The table with names if its lines are seconds, nanoseconds, frame, n joints, and one or three fields of n.

    Two fields could be position and velocity or position and effort, so they stay without names.
    """
    words = [k for k in range(len(table.names)) if np.isnan(table.values[:, k]).all()]
    n = len(words) - 1
    fields = (len(table.names) - len(words) - 2) / n if n > 0 else 0
    if words != list(range(2, 3 + n)) or fields not in (1, len(FIELDS)):
        return table
    joints = [{text for text in table.texts.get(k, {}).values() if text} for k in words[1:]]
    nanoseconds = table.values[:, 1]
    if any(len(names) != 1 for names in joints) or np.any((nanoseconds < 0) | (nanoseconds >= 1e9)):
        return table
    order = [names.pop() for names in joints]
    columns = [f"{field}.{joint}" for field in FIELDS[: int(fields)] for joint in order]
    message = f"joint states as `ros2 topic echo --csv` prints them, of {in_words(order)}"
    remedy = "read as such; otherwise give a mapping with the numbers of the columns"
    finding = noted(str(table.path), "echoed-messages", message, remedy)
    others = tuple(other for other in table.findings if other.code != "no-header")
    names = (*STAMP_FIELDS, *(f"name[{k}]" for k in range(n)), *columns)
    return replace(table, names=names, findings=(*others, finding))


FORMATS = (
    Format((".csv", ".csv.gz"), read_text, batches=batches_of_csv, write=virtual_recording_document),
    Format((".tsv", ".txt", ".dat", ".log", ".tsv.gz", ".txt.gz", ".dat.gz", ".log.gz"), read_text),
)
