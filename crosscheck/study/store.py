"""The store of a study, one SQLite file: what it was begun with, and the outcome of every task that is done.

Every row has a checksum. What is damaged is left out when the file is opened, so that it is computed again.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import sqlite3
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from crosscheck.study.tasks import StudyOutcome
from graphdyn import InvalidInput
from graphdyn.errors import counted
from urdf.document import write_whole

Key = tuple[str, int]
"""Name of a scenario, and number of a run."""

LOCK_TIMEOUT = 1.0
"""Time to wait for another process to leave the file [s]."""

STORE_SCHEMA = 4
"""Number of the form of file and outcomes, and of what runs draw; kept as the user_version of SQLite."""

TABLE_DEFINITIONS = f"""
CREATE TABLE inputs (content TEXT NOT NULL, checksum TEXT NOT NULL);
CREATE TABLE tasks (
    scenario TEXT NOT NULL, run INTEGER NOT NULL, outcome TEXT NOT NULL, checksum TEXT NOT NULL,
    PRIMARY KEY (scenario, run)
);
PRAGMA user_version = {STORE_SCHEMA};
"""

MIN_ROW_BYTES = 100
"""No task takes less of the file."""

HEADER_BYTES = 100
"""Beginning of a database, which says how long it is."""

MAX_STORE_BYTES = 1 << 32
"""No study has so many tasks: a longer database is not what its header says."""

Row = tuple[Any, ...]


class Store:
    """The outcome of every task that is done; each is written for good before the next."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._connection = connection

    def inputs(self) -> dict[str, str]:
        """What the study was begun with; empty where it has just begun."""
        found = self._connection.execute("SELECT content FROM inputs").fetchone()
        return dict(json.loads(found[0])) if found else {}

    def begin(self, inputs: Mapping[str, str]) -> None:
        """Keep what the study is begun with; one that grows is begun anew."""
        with self._connection:
            self._connection.execute("DELETE FROM inputs")
            self.insert("inputs", json.dumps(dict(inputs)))

    def add(self, key: Key, outcome: StudyOutcome) -> None:
        """An outcome, to that of other methods of this task if there is one."""
        found = self._connection.execute("SELECT outcome FROM tasks WHERE scenario = ? AND run = ?", key).fetchone()
        if found:
            outcome = StudyOutcome.from_json(json.loads(found[0])) + outcome
        with self._connection:
            self._connection.execute("DELETE FROM tasks WHERE scenario = ? AND run = ?", key)
            self.insert("tasks", *key, json.dumps(outcome.as_json()))

    def insert(self, table: str, *values: Any) -> None:
        """A row, with its checksum."""
        marks = ", ".join("?" * (len(values) + 1))
        self._connection.execute(f"INSERT INTO {table} VALUES ({marks})", (*values, checksum(*values)))

    def done(self) -> dict[Key, frozenset[str]]:
        """Names of the methods that are done, as in tables, of every task that has some."""
        return {key: frozenset(result.method for result in outcome.results) for key, outcome in self.outcomes()}

    def outcomes(self) -> Iterator[tuple[Key, StudyOutcome]]:
        """Sorted by scenario and run."""
        found = self._connection.execute("SELECT scenario, run, outcome FROM tasks ORDER BY scenario, run")
        for scenario, run, outcome in found:
            yield (scenario, run), StudyOutcome.from_json(json.loads(outcome))


def checksum(*values: Any) -> str:
    return hashlib.sha256(repr(values).encode()).hexdigest()


@contextmanager
def opened(file: Path, tell: Callable[[str], None] | None = None, *, copy_of: Path | None = None) -> Iterator[Store]:
    """No other process can open it in the meantime.

    tell: called with a line where something in the file is damaged, and is left out; copy_of: the file that messages
    name, where this one is a copy of it

    Raises InvalidInput where another process has it open, for other files, and where it is damaged beyond what it was
    begun with; OSError where it cannot be written, as on a full disk.
    """
    named = copy_of or file
    with ExitStack() as opened_now:
        try:
            try:
                connection = opened_now.enter_context(_connected(file, named))
                kept = _kept(connection, named)
            except DamagedStore as damage:
                kept = _kept_of_cut_off(file, named)
                if kept is None:
                    raise damage from None
            if kept is not None:
                opened_now.close()
                _rewrite(file, kept)
                whole = counted(len(kept.tasks), "run")
                (tell or (lambda _: None))(f"{named} is damaged: {whole} can be read, all others are computed again")
                connection = opened_now.enter_context(_connected(file, named))
            yield Store(connection)
        except sqlite3.OperationalError as error:
            raise OSError(f"{named} cannot be written: {error}; make room, and go on with --resume") from None
        except sqlite3.DatabaseError as error:
            raise OSError(f"{named} has been damaged: {error}; go on with --resume") from None


@contextmanager
def _connected(file: Path, named: Path) -> Iterator[sqlite3.Connection]:
    """Raises InvalidInput, which names the file so, where it cannot be opened, and for what is no database."""
    with ExitStack() as opened_now:
        try:
            connection = opened_now.enter_context(closing(sqlite3.connect(file, timeout=LOCK_TIMEOUT)))
            connection.text_factory = partial(str, encoding="utf-8", errors="replace")
            connection.execute("PRAGMA locking_mode = EXCLUSIVE")
            connection.execute("PRAGMA journal_mode = WAL")
            connection.executescript("BEGIN IMMEDIATE; COMMIT;")
            if not connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
                connection.executescript(f"BEGIN IMMEDIATE; {TABLE_DEFINITIONS} COMMIT;")
        except sqlite3.OperationalError as error:
            if "locked" not in str(error):
                raise InvalidInput(f"{named} cannot be opened: {error}") from None
            raise InvalidInput(
                f"{named} is in use: a study writes there; wait for it, or name another folder"
            ) from None
        except sqlite3.DatabaseError as error:
            raise _damaged(named, str(error)) from None
        yield connection


def _kept_of_cut_off(file: Path, named: Path) -> _Kept | None:
    """What can be read of a file that is cut off: with empty pages in place of the lost ones SQLite reads the others.

    None where it is as long as it says, and where its inputs are lost.
    """
    whole = _whole_size(file)
    if not file.stat().st_size < whole <= MAX_STORE_BYTES:
        return None
    with TemporaryDirectory() as folder:
        filled = Path(folder) / file.name
        _copy(file, filled)
        os.truncate(filled, whole)
        with suppress(DamagedStore), _connected(filled, named) as connection:
            return _kept(connection, named)
    return None


def _whole_size(file: Path) -> int:
    """How long a database is by its header [bytes]; 0 where that is not known (sqlite.org/fileformat2.html)."""
    with file.open("rb") as content:
        header = content.read(HEADER_BYTES)
    if len(header) < HEADER_BYTES or header[24:28] != header[92:96]:
        return 0
    page = int.from_bytes(header[16:18], "big")
    return (page if page > 1 else 1 << 16) * int.from_bytes(header[28:32], "big")


MAX_COPIES, COPY_PAUSE = 20, 0.1
"""Copies that are made of a store until nothing is written in the meantime, and the time between [s]."""


@contextmanager
def copied(file: Path) -> Iterator[Store]:
    """A copy of it, whatever another process writes there; what is damaged is left out.

    Raises InvalidInput where there is none, and where it is damaged beyond what it was begun with; OSError where it is
    written all the time.
    """
    if not file.is_file():
        raise InvalidInput(f"{file.parent} holds no study: there is no {file.name}; name the folder of one")
    with TemporaryDirectory() as folder:
        copy = Path(folder) / file.name
        for _ in range(MAX_COPIES):
            before = _stamps(file)
            _copy(file, copy)
            if _stamps(file) == before:
                break
            time.sleep(COPY_PAUSE)
        else:
            raise OSError(f"{file} is written all the time; try again")
        with opened(copy, copy_of=file) as store:
            yield store


def _copy(file: Path, copy: Path) -> None:
    """Copy the database, and the log of what is not in it yet."""
    for name in (file.name, f"{file.name}-wal"):
        with suppress(FileNotFoundError):
            shutil.copyfile(file.with_name(name), copy.with_name(name))


def _stamps(file: Path) -> list[tuple[int, int] | None]:
    """Size and time of database and log; None where there is none."""
    stamps: list[tuple[int, int] | None] = []
    for part in (file, file.with_name(f"{file.name}-wal")):
        try:
            found = part.stat()
        except FileNotFoundError:
            stamps.append(None)
        else:
            stamps.append((found.st_size, found.st_mtime_ns))
    return stamps


class DamagedStore(InvalidInput):
    """A file that is no store, or one that is damaged beyond what can be read."""


def _damaged(file: Path, problem: str) -> DamagedStore:
    return DamagedStore(f"{file} is damaged: {problem}; remove it, or name another folder")


@dataclass(frozen=True)
class _Kept:
    """What can be read of a damaged file.

    inputs: as JSON; tasks: scenario, run and outcome of each
    """

    inputs: str
    tasks: list[Row]


def _kept(connection: sqlite3.Connection, file: Path) -> _Kept | None:
    """None where the file is as it should be. Raises InvalidInput for unknown forms, and where its inputs are lost."""
    (schema,) = connection.execute("PRAGMA user_version").fetchone()
    if schema != STORE_SCHEMA:
        raise InvalidInput(
            f"{file} has form {schema}, and this graphdyn reads form {STORE_SCHEMA}; go on with the one that began it, "
            "or name another folder"
        )
    try:
        whole = connection.execute("PRAGMA integrity_check(1)").fetchone()[0] == "ok"
    except sqlite3.DatabaseError:
        whole = False
    try:
        return _readable(connection, whole)
    except (sqlite3.DatabaseError, LookupError, ValueError):
        raise _damaged(file, "what the study was begun with cannot be read") from None


def _readable(connection: sqlite3.Connection, whole: bool) -> _Kept | None:
    inputs = connection.execute("SELECT content, checksum FROM inputs").fetchall()
    rows = list(_rows(connection, "scenario, run, outcome, checksum", whole))
    if whole and not inputs and not rows:
        return None  # just begun
    ((content,),) = _unchanged(inputs)
    tasks = _unchanged(rows)
    return None if whole and len(tasks) == len(rows) else _Kept(content, tasks)


def _unchanged(rows: list[Row]) -> list[Row]:
    """Rows whose last column is the checksum of the others, without it."""
    return [row[:-1] for row in rows if row[-1] == checksum(*row[:-1])]


def _rows(connection: sqlite3.Connection, columns: str, whole: bool) -> Iterator[Row]:
    """All tasks; of a damaged file those that can be read, one by one."""
    if whole:
        yield from connection.execute(f"SELECT {columns} FROM tasks")
        return
    sizes = [connection.execute(f"PRAGMA {what}").fetchone()[0] for what in ("page_count", "page_size")]
    for number in range(1, sizes[0] * sizes[1] // MIN_ROW_BYTES):
        with suppress(sqlite3.DatabaseError):
            yield from connection.execute(f"SELECT {columns} FROM tasks WHERE rowid = ?", (number,))


def _rewrite(file: Path, kept: _Kept) -> None:
    """The file in today's form, with what was kept. Raises OSError."""
    with closing(sqlite3.connect(":memory:")) as connection:
        connection.executescript(TABLE_DEFINITIONS)
        store = Store(connection)
        with connection:
            store.insert("inputs", kept.inputs)
            for row in kept.tasks:
                store.insert("tasks", *row)
        content = connection.serialize()
    file.with_name(f"{file.name}-wal").unlink(missing_ok=True)  # which belongs to the file before
    write_whole(file, content)
