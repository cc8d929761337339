"""Standard output and standard error of the program: errors, warnings and progress are never mixed with results."""

from __future__ import annotations

import sys
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer
from rich.console import Console

WIDTH = 120
"""Characters of a line where the output is not a terminal (a log, a file, a pipe)."""


SHOWN = 40
"""Characters of what was just done beside a progress bar; the end of a path tells more than its beginning."""


class Output(Console):
    """A console that leaves it to its caller what a reader who left means; rich would exit with code 1."""

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


err = Output(stderr=True, markup=False, highlight=False)
out = Output(markup=False, highlight=False, width=None if sys.stdout.isatty() else WIDTH)


def complain(error: Exception, context: typer.Context) -> None:
    """An error that is the user's to mend, as one line."""
    trace(error, context)
    err.print(f"error: {error}", style="red", soft_wrap=True)


def trace(error: Exception, context: typer.Context) -> None:
    """The traceback, if the program was called with --debug."""
    if context.find_root().params["debug"]:
        err.print("".join(traceback.format_exception(error)), end="", soft_wrap=True)


@contextmanager
def warnings_shown() -> Iterator[None]:
    """Warnings as one line each, without the source line that raised them."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        yield
    for warning in caught:
        err.print(f"warning: {warning.message}", style="yellow", soft_wrap=True)


@contextmanager
def progress(title: str, total: int | None = None) -> Iterator[Callable[[str, int], None]]:
    """A bar on the terminal, silent elsewhere. Yields a function of what was just done, and how many steps of it."""
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    columns = (
        TextColumn("{task.fields[title]}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}", markup=False),
    )
    with Progress(*columns, console=err, transient=True, disable=not err.is_terminal) as bar:
        task = bar.add_task("", total=total, title=title)

        def advance(what: str, steps: int) -> None:
            tail = what if len(what) <= SHOWN else f"…{what[1 - SHOWN :]}"
            bar.update(task, advance=steps, description=tail)

        yield advance
