"""What a study has done so far: one SQLite file, written by one process, whole after every task whatever ends it."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path

from crosscheck.study.tasks import StudyOutcome
from graphdyn import InvalidInput

Key = tuple[str, int]
"""Name of a scenario, and number of a run."""

LOCK_TIMEOUT = 1.0
"""Time to wait for another process to leave the file [s]."""

TABLE_DEFINITIONS = """
CREATE TABLE IF NOT EXISTS inputs (name TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS tasks (
    scenario TEXT NOT NULL, run INTEGER NOT NULL, outcome TEXT NOT NULL, PRIMARY KEY (scenario, run)
);
"""


class Database:
    """The outcome of every task that is done; each is written for good before the next."""

    def __init__(self, connection: sqlite3.Connection) -> None:
        self._connection = connection

    def inputs(self) -> dict[str, str]:
        """What the study was begun with; empty where it has just begun."""
        return dict(self._connection.execute("SELECT name, value FROM inputs"))

    def begin(self, inputs: Mapping[str, str]) -> None:
        with self._connection:
            self._connection.executemany("INSERT INTO inputs VALUES (?, ?)", inputs.items())

    def write(self, key: Key, outcome: StudyOutcome) -> None:
        with self._connection:
            self._connection.execute("INSERT INTO tasks VALUES (?, ?, ?)", (*key, json.dumps(outcome.as_json())))

    def done(self) -> set[Key]:
        return set(self._connection.execute("SELECT scenario, run FROM tasks"))

    def outcomes(self) -> Iterator[tuple[Key, StudyOutcome]]:
        """Sorted by scenario and run."""
        for scenario, run, outcome in self._connection.execute("SELECT * FROM tasks ORDER BY scenario, run"):
            yield (scenario, run), StudyOutcome.from_json(json.loads(outcome))


@contextmanager
def opened(file: Path) -> Iterator[Database]:
    """No other process can open it in the meantime.

    Raises InvalidInput where one has, and for other files; OSError where it cannot be written, as on a full disk.
    """
    with closing(sqlite3.connect(file, timeout=LOCK_TIMEOUT)) as connection:
        try:
            connection.execute("PRAGMA locking_mode = EXCLUSIVE")
            connection.execute("PRAGMA journal_mode = WAL")
            connection.executescript(f"BEGIN IMMEDIATE; {TABLE_DEFINITIONS} COMMIT;")
        except sqlite3.OperationalError as error:
            if "locked" not in str(error):
                raise InvalidInput(f"{file} cannot be opened: {error}") from None
            raise InvalidInput(f"{file} is in use: a study writes there; wait for it, or name another folder") from None
        except sqlite3.DatabaseError as error:
            raise InvalidInput(f"{file} is damaged: {error}; remove it, or name another folder") from None
        try:
            yield Database(connection)
        except sqlite3.OperationalError as error:
            raise OSError(f"{file} cannot be written: {error}; make room, and go on with --resume") from None
