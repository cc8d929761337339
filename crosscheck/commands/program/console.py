"""Standard output, for results, and standard error, for errors, warnings and progress.

Output on terminals and into files whose encoding has no Greek letters, arrows or frames: spelled in ASCII.
"""

from __future__ import annotations

import codecs
import io
import logging
import os
import sys
import time
import traceback
import unicodedata
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from errno import EACCES, EAGAIN, EISDIR, ENOENT, ENOSPC
from sys import stdout

import typer
from rich.console import Console
from rich.text import Text

from crosscheck.report.plain_text import bounded, printable
from graphdyn import GraphDynError

LINE_CHARACTERS = 120
"""Characters per line where the output is not a terminal (a file, a pipe)."""

MAX_STEP_CHARACTERS = 48
"""Largest number of characters of the step shown beside a progress bar; of a long path, the end is shown."""

PROGRESS_INTERVAL = 10.0
"""Time from one line of progress to the next where nobody looks at a bar [s]."""

SYSTEM_ERROR_REMEDIES = {
    ENOENT: "check the name and the folder",
    EACCES: "check who may read and write it",
    EISDIR: "name a file",
    ENOSPC: "make room, or write elsewhere",
}
"""Remedies by number of an error of the system."""

Advance = Callable[[str, int], None]
"""Called with what was just done, and the number of its steps; 0 steps for what begins."""


class PipeConsole(Console):
    """A console that raises BrokenPipeError when its reader has closed the pipe; rich would exit with code 1."""

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


err = PipeConsole(stderr=True, markup=False, highlight=False)
out = PipeConsole(markup=False, highlight=False, width=None if stdout and stdout.isatty() else LINE_CHARACTERS)


def say(text: str, style: str | None = None) -> None:
    """A line on standard error. It may hold names and messages of others, line breaks among them."""
    err.print(Text(printable(bounded(text))), style=style, soft_wrap=True)


def complain(error: Exception, context: typer.Context) -> None:
    """Print an error that the user can correct, as one line, or one for each of its problems."""
    trace(error, context)
    several = error.problems if isinstance(error, GraphDynError) else ()
    for problem in several or (in_words(error),):
        say(f"error: {problem}", "red")
    if command := mending_command(error):
        say(f"mended by: {command}")


def mending_command(error: Exception) -> str:
    """What mends a robot file that was refused for this; "" where nothing that is known does."""
    from crosscheck.commands.program.repair_commands import repair_command
    from urdf import REPAIRED_CODES, URDFError, repair

    if not isinstance(error, URDFError) or error.path is None or error.code not in REPAIRED_CODES:
        return ""
    try:
        found = repair(error.path, None, [error.code])
    except (GraphDynError, OSError):
        return ""
    return repair_command(str(error.path), [error.code]) if found.changes else ""


def in_words(error: Exception) -> str:
    """The message; of an error of the system the file, the reason and the remedy, without its number."""
    if isinstance(error, OSError) and error.errno == EAGAIN:
        return "no further process can be started; end other programs, or allow more of them (ulimit -u)"
    if not isinstance(error, OSError) or error.filename is None or not error.strerror:
        return str(error)
    remedy = f"; {SYSTEM_ERROR_REMEDIES[error.errno]}" if error.errno in SYSTEM_ERROR_REMEDIES else ""
    return f"{error.filename}: {error.strerror[0].lower()}{error.strerror[1:]}{remedy}"


def trace(error: BaseException, context: typer.Context) -> None:
    """Print the traceback, if the program was called with --debug."""
    if context.find_root().params["debug"]:
        err.print(Text(printable("".join(traceback.format_exception(error)), keep="\n")), end="", soft_wrap=True)


warned: list[str] = []
"""The warnings of the command so far, each once: its page and its JSON file tell them too."""


def warn(message: Warning | str, *_: object, severity: str = "warning") -> None:
    """Print a warning as one line, without the source line that raised it, and keep it for pages and files."""
    say(f"{severity}: {message}", "yellow")
    if str(message) not in warned:
        warned.append(str(message))


@contextmanager
def warnings_shown() -> Iterator[None]:
    """All warnings, when the work is done: they would tear a progress bar."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    for warning in caught:
        warn(warning.message)


def in_notebook() -> bool:
    """Whether a cell of a notebook runs the program (`!graphdyn`): it shows colors, and no moves of the cursor."""
    return "JPY_PARENT_PID" in os.environ or "matplotlib_inline" in os.environ.get("MPLBACKEND", "")


@contextmanager
def progress(title: str, total: int | None = None) -> Iterator[Advance]:
    """A bar on a terminal; elsewhere a line on standard error from time to time, none for what is done quickly.

    Cells of notebooks count as elsewhere. Messages of the packages' loggers are shown beside it: what begins, in the
    parts that take long.
    """
    moving = err.is_terminal and not in_notebook()
    with _bar(title, total) if moving else nullcontext(_lines(title, total)) as advance, _told(advance):
        yield advance


@contextmanager
def _bar(title: str, total: int | None) -> Iterator[Advance]:
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.fields[title]}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=err, transient=True) as bar:
        task = bar.add_task("", total=total, title=printable(title))
        done = ""

        def advance(what: str, steps: int) -> None:
            nonlocal done
            done = what if steps else done
            both = f"{done}, {what}"
            shown = both if not steps and done and len(both) <= MAX_STEP_CHARACTERS else what
            tail = shown if len(shown) <= MAX_STEP_CHARACTERS else f"…{shown[1 - MAX_STEP_CHARACTERS :]}"
            bar.update(task, advance=steps, description=printable(tail))

        yield advance


@contextmanager
def _told(advance: Advance) -> Iterator[None]:
    """Inside, what the packages log is told as what begins."""
    from crosscheck.distributing.processes import LOGGERS  # imported where first used: help needs no processes

    handler = _Phases(advance)
    loggers = {logger: logger.level for logger in map(logging.getLogger, LOGGERS)}
    for logger in loggers:
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        for logger, level in loggers.items():
            logger.removeHandler(handler)
            logger.setLevel(level)


class _Phases(logging.Handler):
    def __init__(self, advance: Advance) -> None:
        super().__init__(logging.INFO)
        self._advance = advance

    def emit(self, record: logging.LogRecord) -> None:
        if record.levelno == logging.INFO:
            self._advance(record.getMessage(), 0)


def _lines(title: str, total: int | None) -> Advance:
    """Such as "crosscheck: 12 of 340 after 80 s, arms/ur5.urdf", at most one in each PROGRESS_INTERVAL."""
    start = last = time.monotonic()
    done = 0

    def advance(what: str, steps: int) -> None:
        nonlocal last, done
        now, done = time.monotonic(), done + steps
        if now - last >= PROGRESS_INTERVAL:
            last = now
            of = "" if total is None else f" of {total}"
            say(f"{title}: {done}{of} after {now - start:.0f} s{', ' if what else ''}{what}")

    return advance


ASCII_SPELLING = str.maketrans(
    {
        **dict.fromkeys("–—−‒‐", "-"), **dict.fromkeys("·•×", "*"), **dict.fromkeys("“”", '"'),
        **dict.fromkeys("‘’", "'"),
        "…": "...", "→": "->", "←": "<-", "≤": "<=", "≥": ">=", "≠": "!=", "≈": "~", "∞": "inf", "√": "sqrt", "‖": "|",
        "✓": "+", "✗": "x", "±": "+-", "°": "deg", "⁻": "-", "∂": "d", "µ": "u", "μ": "u",
    }
)  # fmt: skip
"""What the reports of the program use, in characters that every encoding has."""


def accept_all_characters() -> None:
    """Standard output and standard error spell what their encoding does not have, in place of an exception."""
    codecs.register_error("spelled", _spelled)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and not stream.encoding.lower().startswith("utf"):
            stream.reconfigure(errors="spelled")


def spelled(text: str) -> str:
    """The text in ASCII: τ as tau, ẍ as x, 10⁻³ as 10-3; other characters as Python writes them, as \\u4e2d."""
    return "".join(map(_letter, text.translate(ASCII_SPELLING)))


def _letter(character: str) -> str:
    letters = (c for c in unicodedata.normalize("NFKD", character) if not unicodedata.combining(c))
    return "".join(c if c.isascii() else _greek(c) or c.encode("ascii", "backslashreplace").decode() for c in letters)


def _greek(letter: str) -> str:
    """Its name, "" for other letters."""
    script, *_, name = unicodedata.name(letter, "NO NAME").split()
    return (
        {"Ll": name.lower(), "Lu": name.capitalize()}.get(unicodedata.category(letter), "") if script == "GREEK" else ""
    )


def _spelled(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return spelled(error.object[error.start : error.end]), error.end
