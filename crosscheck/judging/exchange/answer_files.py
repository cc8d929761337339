"""Files of answers: an id and the numbers of the answer, in CSV, JSON, NumPy or Parquet."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from crosscheck.judging.exchange.line_process import shown
from crosscheck.judging.exchange.protocols import UnreadableAnswer, flat_numbers
from graphdyn import GraphDynError
from graphdyn.layout import Array


class BadAnswers(GraphDynError):
    """A file of answers that cannot be read, or answers that are missing or doubled."""


@dataclass(frozen=True, eq=False)
class GivenAnswer:
    """The numbers of one answer (m,), and where they stand: "answers.csv, line 7"."""

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
    text = path.read_bytes().decode("utf-8-sig", errors="replace")
    for row, line in enumerate(text.splitlines(), start=1):
        cells = [cell for cell in re.split(r"\s*[,;]\s*|\s+", line.strip()) if cell]
        if not cells or (row == 1 and not _is_number(cells[0])):
            continue
        where = f"{path}, line {row}"
        wrong = next((cell for cell in cells if not _is_number(cell)), None)
        if wrong is not None:
            raise BadAnswers(f"{where}: {shown(wrong)} is no number; write the id and the numbers of the answer")
        yield _id(float(cells[0]), where), GivenAnswer(np.array([float(cell) for cell in cells[1:]]), where)


def _json(path: Path) -> Iterator[tuple[int, GivenAnswer]]:
    try:
        rows = json.loads(path.read_bytes())
    except ValueError as error:
        raise BadAnswers(f"{path}: is no JSON: {error}") from None
    form = '[{"id": …, "answer": […]}, …]'
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
        with np.load(path, allow_pickle=False) as arrays:
            found = {name: np.asarray(arrays[name]) for name in arrays.files}
    except (ValueError, OSError, EOFError, KeyError, BadZipFile) as error:
        if isinstance(error, FileNotFoundError):
            raise
        raise BadAnswers(f"{path}: is no archive of NumPy arrays: {error}") from None
    pairs = [name for name in found if name == "id" or name.endswith(".id")]
    if not pairs:
        raise BadAnswers(f"{path}: has no array 'id'; name two id and answer, or FUNCTION.id and FUNCTION.answer")
    for name in pairs:
        other = f"{name[:-2]}answer"
        if other not in found or len(found[other]) != len(found[name]):
            raise BadAnswers(f"{path}: '{other}' needs one row for each of the {len(found[name])} entries of '{name}'")
        for row, (number, answer) in enumerate(zip(found[name], found[other], strict=True)):
            where = f"{path}, {other}[{row}]"
            if answer.dtype.kind not in "fiu":
                raise BadAnswers(f"{where}: is of type {answer.dtype}; give real numbers")
            yield _id(float(number), where), GivenAnswer(answer.astype(float).ravel(), where)


def _parquet(path: Path) -> Iterator[tuple[int, GivenAnswer]]:
    import pyarrow as pa
    import pyarrow.parquet

    path.open("rb").close()  # a missing file is no file of another kind
    try:
        table = pyarrow.parquet.read_table(path)
    except (pa.ArrowException, OSError) as error:
        raise BadAnswers(f"{path}: is no Parquet file: {error}") from None
    if not {"id", "answer"} <= set(table.column_names):
        raise BadAnswers(f"{path}: has the columns {', '.join(table.column_names)}; name them id and answer")
    rows = zip(table["id"].to_pylist(), table["answer"].to_pylist(), strict=True)
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
    if isinstance(number, bool) or not isinstance(number, int | float):
        raise BadAnswers(f"{where}: the id is {number!r}; give that of a question, a number")
    try:
        numbers = flat_numbers(answer)
    except UnreadableAnswer as error:
        raise BadAnswers(f"{where}, id {number}: {error}") from None
    return _id(float(number), where), GivenAnswer(numbers, where)


def _id(number: float, where: str) -> int:
    if not number.is_integer():
        raise BadAnswers(f"{where}: {number:.17g} is no id; begin with that of the question, and write all its digits")
    return int(number)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
