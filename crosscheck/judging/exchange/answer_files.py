"""Files of answers: an id and the numbers of the answer, in CSV, JSON, NumPy or Parquet."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from crosscheck.judging.exchange.csv_dialects import plain_lines
from crosscheck.judging.exchange.printed_numbers import (
    BeyondDoubles,
    UnreadableAnswer,
    as_array,
    flat_numbers,
    printed_numbers,
    read_json,
    whole_number,
)
from crosscheck.recordings.errors import BadRecordingFile, quoted
from crosscheck.recordings.formats.npz_files import npz_arrays
from crosscheck.recordings.formats.parquet_files import parquet_table
from graphdyn import GraphDynError
from graphdyn.errors import counted
from graphdyn.layout import Array


class BadAnswers(GraphDynError):
    """A file of answers that cannot be read, or answers that are missing or doubled."""


@dataclass(frozen=True, eq=False)
class GivenAnswer:
    """The numbers of one answer (m,), of objects where some are a LongDecimal, and where they stand: "answers.csv, line
    7"."""

    numbers: Array
    where: str


def read_answers(files: Sequence[Path]) -> dict[int, GivenAnswer]:
    """The answers by id. Raises BadAnswers, naming the file, the row and the id; OSError."""
    found: dict[int, GivenAnswer] = {}
    for path in files:
        reader = READERS.get(path.suffix.lower())
        if reader is None:
            raise BadAnswers(f"{path}: no file of answers ends in '{path.suffix}'; give {', '.join(READERS)}")
        rows = list(reader(path))
        for number, answer in rows:
            if number in found:
                raise BadAnswers(f"id {number} is answered twice: in {found[number].where} and in {answer.where}")
            found[number] = answer
        if not rows:
            raise BadAnswers(f"{path}: no answers; give a row with the id and the numbers for each question")
    return found


def _csv(path: Path) -> Iterator[tuple[int, GivenAnswer]]:
    """Rows of an id and numbers, with commas, semicolons or blanks between them; a first line of words is a head."""
    lines = plain_lines(path.read_bytes())
    for row, line in enumerate(lines, start=1):
        where = f"{path}, line {row}"
        try:
            numbers = printed_numbers(line)
        except UnreadableAnswer as error:
            if row == 1 and not re.match(r"\s*[-+.0-9]", line):
                continue
            raise BadAnswers(f"{where}: {error}; write the id and the numbers of the answer") from None
        if numbers:
            yield _id(numbers[0], where), GivenAnswer(as_array(numbers[1:]), where)


def _json(path: Path) -> Iterator[tuple[int, GivenAnswer]]:
    form = '[{"id": …, "answer": […]}, …]'
    try:
        rows = read_json(path.read_bytes())
    except UnreadableAnswer as error:
        raise BadAnswers(f"{path}: {error}; the form is {form}") from None
    if not isinstance(rows, list):
        raise BadAnswers(f"{path}: holds no list; the form is {form}")
    for number, row in enumerate(rows, start=1):
        where = f"{path}, entry {number}"
        if not isinstance(row, dict) or "id" not in row or "answer" not in row:
            raise BadAnswers(f"{where}: has no id and answer; the form is {form}")
        yield _entry(row["id"], row["answer"], where)


def _npz(path: Path) -> Iterator[tuple[int, GivenAnswer]]:
    """Pairs of arrays id (N,) and answer (N, …), or FUNCTION.id and FUNCTION.answer."""
    try:
        found = npz_arrays(path)
    except BadRecordingFile as error:
        raise BadAnswers(str(error)) from None
    pairs = [name for name in found if name == "id" or name.endswith(".id")]
    if not pairs:
        raise BadAnswers(f"{path}: has no array 'id'; name two id and answer, or FUNCTION.id and FUNCTION.answer")
    for name in pairs:
        ids, other = found[name], f"{name[:-2]}answer"
        if ids.ndim != 1 or ids.dtype.kind not in "fiu":
            raise BadAnswers(f"{path}: '{name}' is no row of ids (N,), but {_described(ids)}; give their numbers")
        if other not in found or found[other].shape[:1] != ids.shape:
            raise BadAnswers(f"{path}: '{other}' needs {counted(len(ids), 'row')}, one for each entry of '{name}'")
        answers = found[other]
        if answers.dtype.kind not in "fiu":
            raise BadAnswers(f"{path}, {other}[0]: is of type {answers.dtype}; give real numbers")
        if answers.dtype.kind == "f":
            answers = answers.astype(float)
        for row, (number, answer) in enumerate(zip(ids.tolist(), answers, strict=True)):
            yield _entry(number, answer.ravel().tolist(), f"{path}, {other}[{row}]")


def _described(array: NDArray[Any]) -> str:
    return f"of shape {array.shape} and type {array.dtype}"


def _parquet(path: Path) -> Iterator[tuple[int, GivenAnswer]]:
    try:
        table = parquet_table(path)
    except BadRecordingFile as error:
        raise BadAnswers(str(error)) from None
    names = table.column_names
    if names.count("id") != 1 or names.count("answer") != 1:
        raise BadAnswers(f"{path}: has the columns {', '.join(names)}; name them id and answer")
    try:
        rows = list(zip(table["id"].to_pylist(), table["answer"].to_pylist(), strict=True))
    except (ValueError, OverflowError) as error:  # texts and times that Python cannot hold
        raise BadAnswers(f"{path}: {error}; give numbers") from None
    for row, (number, answer) in enumerate(rows, start=1):
        yield _entry(number, answer, f"{path}, row {row}")


READERS: Mapping[str, Callable[[Path], Iterator[tuple[int, GivenAnswer]]]] = {
    ".csv": _csv,
    ".json": _json,
    ".npz": _npz,
    ".parquet": _parquet,
}
"""Readers by the ending of the name."""


def _entry(number: Any, answer: Any, where: str) -> tuple[int, GivenAnswer]:
    found = _id(number, where)
    try:
        return found, GivenAnswer(flat_numbers(answer), where)
    except UnreadableAnswer as error:
        raise BadAnswers(f"{where}, id {found}: {error}; give real numbers") from None


def _id(number: Any, where: str) -> int:
    if not isinstance(number, int | float | BeyondDoubles) or isinstance(number, bool):
        raise BadAnswers(f"{where}: the id is {quoted(str(number))}; give that of a question, a number")
    found = whole_number(number)
    if found is None:
        said = f"{number:.17g}" if isinstance(number, float) else quoted(str(number)).strip("'")
        raise BadAnswers(f"{where}: {said} is no id; begin with that of the question, and write all its digits")
    return found
