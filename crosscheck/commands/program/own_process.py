"""The command again in a process of its own, whose end is noticed however user code brings it about.

User code may end its process (os._exit, sys.exit, a signal, a fault in a compiled extension). An exit code alone
cannot tell this from a result, so the process tells its exit code through a pipe when the command is complete.
"""

from __future__ import annotations

import faulthandler
import os
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess

import typer

from crosscheck.commands.program import console
from crosscheck.commands.program.console import accept_all_characters
from crosscheck.distributing.processes import end_with_parent
from crosscheck.judging.exchange.line_process import Watcher, end_in_words
from graphdyn import GraphDynError

UNWINDING_TIME = 5.0
"""Time that the process has to unwind before it is killed [s]."""

program: Callable[[], None] | None = None
"""Runs the command line; set by crosscheck.commands.application, whose commands this file serves."""

tell: Callable[[str], None] | None = None
"""Hook in the process of the command that says to the program which user code is about to run. None in the program
itself."""


class UserCodeEnded(GraphDynError):
    """User code ended the process that it ran in."""


def enter(what: str) -> None:
    """Return where this is the process of the command. Otherwise start it, wait, and end with its exit code.

    what: the user code that is about to run, for messages
    Raises UserCodeEnded where the process ends before the command is complete; typer.Exit with its exit code.
    """
    if tell is not None:
        tell(what)
        return
    assert program is not None
    context = get_context("spawn")
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=_run, args=(program, theirs))
    process.start()
    theirs.close()
    running: list[str] = []
    with _group_of(process):
        try:
            code = _told(process, ours, running)
            process.join()
        except BaseException:  # Ctrl-C, or SIGTERM
            _end(process, signal.SIGINT if running else signal.SIGTERM)
            raise
    if code is None:
        raise UserCodeEnded(
            f"the process {end_in_words(process.exitcode)} while it ran {' and '.join(running) or what}; there is no "
            "result: a function has to return, or to raise an exception"
        )
    raise typer.Exit(code)


def _told(process: BaseProcess, ours: Connection, running: list[str]) -> int | None:
    """The exit code, None where the process ended without reporting it. running: filled with the user code that ran"""
    while True:
        wait([ours, process.sentinel])
        try:
            told = ours.recv() if ours.poll() else None
        except (EOFError, OSError):
            told = None
        if not isinstance(told, str):
            return told
        running.append(told)


@contextmanager
def _group_of(process: BaseProcess) -> Iterator[None]:
    """The process in a group of its own; what user code has started there ends with it, and however this program ends.

    Windows has no groups of processes.
    """
    if not hasattr(os, "killpg"):
        yield
        return
    assert process.pid is not None
    with suppress(OSError):  # it does so itself, if that was earlier
        os.setpgid(process.pid, process.pid)
    watcher = Watcher(process.pid)
    try:
        yield
    finally:
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(process.pid, signal.SIGKILL)
        watcher.close()


def _end(process: BaseProcess, number: int) -> None:
    """End the process by this signal, and wait until it has unwound. Ctrl-C reaches only the program's own group."""
    if process.pid is not None:
        with suppress(ProcessLookupError):
            os.kill(process.pid, number)
    process.join(UNWINDING_TIME)
    if process.exitcode is None:
        process.kill()
        process.join()


def _run(again: Callable[[], None], theirs: Connection) -> None:
    """The program, in the process of the command. SIGINT unwinds it, also where who started the program ignores it;
    other signals end it at once."""
    global tell
    tell = theirs.send
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    end_with_parent()
    faulthandler.enable()  # says in which line of Python a compiled extension crashed
    accept_all_characters()
    _keep_standard_output()
    try:
        again()
    except SystemExit as end:
        console.out.file.flush()
        sys.stderr.flush()
        theirs.send(end.code or 0)
        os._exit(0)  # whatever user code has left to be done at exit


def _keep_standard_output() -> None:
    """Keep standard output for results alone: what user code prints goes to standard error, also where it is not
    written in Python."""
    kept = os.dup(sys.stdout.fileno())
    console.out.file = open(kept, "w", encoding=sys.stdout.encoding, errors=sys.stdout.errors)  # noqa: SIM115
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    sys.stdout = sys.stderr
