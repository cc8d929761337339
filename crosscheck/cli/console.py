"""Standard output, for results, and standard error, for errors, warnings and progress."""

from __future__ import annotations

import sys
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import typer
from rich.console import Console

WIDTH = 120
"""Characters per line where the output is not a terminal (a file, a pipe)."""


SHOWN = 40
"""Largest number of characters of the step shown beside a progress bar; of a long path, the end is shown."""


class Output(Console):
    """A console that raises BrokenPipeError when its reader has closed the pipe; rich would exit with code 1."""

    def on_broken_pipe(self) -> None:
        raise BrokenPipeError


err = Output(stderr=True, markup=False, highlight=False)
out = Output(markup=False, highlight=False, width=None if sys.stdout.isatty() else WIDTH)


def complain(error: Exception, context: typer.Context) -> None:
    """Print an error that the user can correct, as one line."""
    trace(error, context)
    err.print(f"error: {error}", style="red", soft_wrap=True)


def trace(error: Exception, context: typer.Context) -> None:
    """Print the traceback, if the program was called with --debug."""
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
    """A progress bar on the terminal, nothing elsewhere. Yields advance(what was just done, number of its steps)."""
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
