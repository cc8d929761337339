"""User code that is not Python, as options name it: programs and C functions of shared libraries."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from crosscheck.commands.program.reading_options import pairs

if TYPE_CHECKING:
    from crosscheck.judging.exchange.program import ProgramFunction


@dataclass(frozen=True, kw_only=True)
class ProgramOptions:
    """Programs and C functions."""

    PANEL: ClassVar[str] = "Functions in other languages (docs/languages.md)"

    command: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME='PROGRAM …'",
            help="A program that computes a function: it reads a line of numbers (q v a, separated by blanks) and "
            "writes a line of numbers, a matrix row by row. Repeatable.",
        ),
    ] = None
    protocol: Annotated[
        Literal["plain", "json"], typer.Option(help="Lines of --command: plain numbers, or JSON with named fields.")
    ] = "plain"
    time_limit: Annotated[
        float,
        typer.Option(
            min=0.001, metavar="SECONDS", help="Time for each call of a function, start-up of a program included."
        ),
    ] = 30.0
    restart_after: Annotated[
        int | None,
        typer.Option(min=1, metavar="N", show_default="never", help="Restart the program of --command after N lines."),
    ] = None
    library: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=FILE:SYMBOL",
            help="A C function of a shared library: int f(int n, const double *q, const double *v, const double *a, "
            "double *tau), which returns 0. Repeatable.",
        ),
    ] = None


@contextmanager
def user_programs(options: ProgramOptions) -> Iterator[Mapping[str, ProgramFunction]]:
    """The functions by name; their programs end with this context.

    Raises typer.BadParameter, saying what is wrong.
    """
    from crosscheck.judging.exchange.program import ProgramFunction, library_function
    from crosscheck.judging.exchange.protocols import PROTOCOLS_BY_NAME
    from crosscheck.quantities import FUNCTIONS

    found: dict[str, ProgramFunction] = {}
    for name, text in pairs("--command", options.command, "NAME='PROGRAM …'"):
        what, words = f"--command {name}={text}", _words(name, text)
        found[name] = ProgramFunction(
            words, what, PROTOCOLS_BY_NAME[options.protocol], options.time_limit, options.restart_after
        )
    for name, text in pairs("--library", options.library, "NAME=FILE:SYMBOL"):
        if name in found:
            raise typer.BadParameter(f"{name} is named by --command and by --library; name it once")
        if name in FUNCTIONS and "p" in FUNCTIONS[name].shape:
            raise typer.BadParameter(f"--library {name}={text}: nobody knows the size of its answer; use --command")
        found[name] = library_function(*_file_and_symbol(name, text), options.time_limit)
    try:
        yield found
    finally:
        for function in found.values():
            function.close()


def _words(name: str, text: str) -> list[str]:
    try:
        return shlex.split(text)
    except ValueError as error:
        raise typer.BadParameter(f"--command {name}={text}: {error}; close the quotation") from None


def _file_and_symbol(name: str, text: str) -> tuple[Path, str]:
    file, _, symbol = text.rpartition(":")
    if not file or not symbol:
        raise typer.BadParameter(f"--library {name}={text}: give FILE:SYMBOL")
    if not Path(file).is_file():
        raise typer.BadParameter(f"--library {name}={text}: there is no file {file}")
    return Path(file), symbol
