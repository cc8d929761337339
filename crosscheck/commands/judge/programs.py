"""Foreign code that is not Python, as options name it: programs and C functions of shared libraries."""

from __future__ import annotations

import shlex
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from crosscheck.commands.program.judged_functions import pairs

if TYPE_CHECKING:
    from crosscheck.judging.exchange.program import ProgramFunction

CommandOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME='PROGRAM …'",
        help="A program that computes a function: it reads a line of numbers (q v a, with blanks) and writes a line of "
        "numbers, a matrix row by row. Repeatable.",
    ),
]
ProtocolOption = Annotated[
    Literal["plain", "json"], typer.Option(help="Lines of --command: plain numbers, or JSON with named fields.")
]
TimeLimitOption = Annotated[
    float,
    typer.Option(min=0.001, metavar="SECONDS", help="For each answer of --command and --library, the start included."),
]
RestartOption = Annotated[
    int | None,
    typer.Option(
        min=1,
        metavar="N",
        help="Close the input of --command after N lines, and start it anew for the next; never, if left out.",
    ),
]
LibraryOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=FILE:SYMBOL",
        help="A C function of a shared library: int f(int n, const double *q, const double *v, const double *a, "
        "double *tau), which returns 0. Repeatable.",
    ),
]


@contextmanager
def foreign_programs(
    commands: list[str] | None, libraries: list[str] | None, protocol: str, time_limit: float, restart_after: int | None
) -> Iterator[Mapping[str, ProgramFunction]]:
    """The functions by name; their programs end with this context.

    Raises typer.BadParameter, saying what is wrong.
    """
    from crosscheck.judging.exchange.library import library_function
    from crosscheck.judging.exchange.program import ProgramFunction
    from crosscheck.judging.exchange.protocols import PROTOCOLS_BY_NAME
    from crosscheck.judging.functions.table import FUNCTIONS

    found: dict[str, ProgramFunction] = {}
    for name, text in pairs("--command", commands, "NAME='PROGRAM …'"):
        what, words = f"--command {name}={text}", _words(name, text)
        found[name] = ProgramFunction(words, what, PROTOCOLS_BY_NAME[protocol], time_limit, restart_after)
    for name, text in pairs("--library", libraries, "NAME=FILE:SYMBOL"):
        if name in found:
            raise typer.BadParameter(f"{name} is named by --command and by --library; name it once")
        if name in FUNCTIONS and "p" in FUNCTIONS[name].shape:
            raise typer.BadParameter(f"--library {name}={text}: nobody knows the size of its answer; use --command")
        found[name] = library_function(*_file_and_symbol(name, text), time_limit)
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
