"""A process that ends another one with us, however we end.

A program that reads a line per question and writes a line per answer, in a process of its own.

Lines are written and read at the same time, so that neither side waits for the other with full pipes.
"""

from __future__ import annotations

import os
import selectors
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from errno import ENOEXEC
from pathlib import Path

from graphdyn import GraphDynError


class Watcher:
    """Kills a group of processes as soon as this program has ended, even if that was killed.

    group: number of the group, that of the process that leads it

    Raises OSError where no process can be started; then the leader is killed at once.
    """

    def __init__(self, group: int):
        end_of_input = f"read -r _; kill -9 -{group}"  # only we hold the other end open
        try:
            self._process = subprocess.Popen(
                ["/bin/sh", "-c", end_of_input],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                start_new_session=True,
            )
        except OSError:
            with suppress(ProcessLookupError):
                os.kill(group, signal.SIGKILL)
            raise

    def close(self) -> None:
        """Watch no longer."""
        self._process.kill()
        self._process.communicate()


CLOSING_TIMEOUT = 1.0
"""Time that a program has to end, or to write what it holds back, once its input is closed [s]."""

MAX_LINE_BYTES = 10**7
"""Largest number of bytes without the end of a line."""

MAX_REPEATED_ERROR = 1000
"""Largest number of characters of its standard error that a message repeats, the last ones."""

MAX_REPEATED_LINE = 80
"""Largest number of characters of a line that a message repeats."""

READ_BYTES = 1 << 16


class ProgramFailed(GraphDynError):
    """A program could not be started, ended, did not answer in time, or wrote what is no answer."""


class LineProcess:
    """A running program.

    command: its name and arguments; time_limit: for each answer [s]
    what: its name in messages

    Raises ProgramFailed where it cannot be started.
    """

    def __init__(self, command: Sequence[str], what: str, time_limit: float):
        self._what, self._time_limit = what, time_limit
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115, closed with the process
        try:
            self._process = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._errors,
                bufsize=0,
                start_new_session=True,
            )
        except OSError as error:
            self._errors.close()
            raise ProgramFailed(f"{what} cannot be started: {_reason(command[0], error)}") from error
        self._watcher = Watcher(self._process.pid)
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._input, self._output = self._process.stdin, self._process.stdout
        os.set_blocking(self._input.fileno(), False)
        self._rest = b""

    def answers(self, questions: Sequence[str], *, last: bool) -> list[str]:
        """The line that it writes for each question; blank ones do not count.

        last: close its input after these questions

        Raises ProgramFailed.
        """
        unwritten = memoryview("".join(f"{question}\n" for question in questions).encode())
        lines: list[str] = []
        deadline = time.monotonic() + self._time_limit
        with selectors.DefaultSelector() as ready:
            ready.register(self._output, selectors.EVENT_READ)
            ready.register(self._input, selectors.EVENT_WRITE)
            while len(lines) < len(questions):
                events = ready.select(max(0.0, deadline - time.monotonic()))
                if not events:
                    raise self._late(len(lines), questions)
                for key, _ in events:
                    if key.fileobj is self._input:
                        unwritten = self._write(unwritten)
                        if not unwritten:
                            ready.unregister(self._input)
                            if last:
                                self._input.close()
                        continue
                    found = self._lines()
                    if found is None:
                        raise self._ended(len(lines), questions)
                    lines += found
                    if found:
                        deadline = time.monotonic() + self._time_limit
        if len(lines) > len(questions) or self._rest:
            surplus = lines[len(questions)] if len(lines) > len(questions) else self._rest.decode(errors="replace")
            raise ProgramFailed(
                f"{self._what} wrote more than the {len(questions)} lines that answer its questions, such as "
                f"{shown(surplus)}: write one line per question, a matrix row by row in one line, and everything else "
                "to standard error"
            )
        return lines

    def close(self) -> None:
        """End the program and what it has started."""
        with suppress(OSError):
            self._input.close()
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(CLOSING_TIMEOUT)
        self._kill()
        self._output.close()
        self._errors.close()

    def _kill(self) -> int:
        """Its exit code; minus the number of a signal."""
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._watcher.close()
        return self._process.wait()

    def _write(self, unwritten: memoryview) -> memoryview:
        """What is left to write; nothing, where it reads no more."""
        try:
            return unwritten[os.write(self._input.fileno(), unwritten[:READ_BYTES]) :]
        except BlockingIOError:
            return unwritten
        except BrokenPipeError:
            return unwritten[:0]

    def _lines(self) -> list[str] | None:
        """The lines that have arrived; None at the end of its output. A last line need not be ended."""
        chunk = os.read(self._output.fileno(), READ_BYTES)
        *whole, self._rest = (self._rest + (chunk or b"\n")).split(b"\n")
        if len(self._rest) > MAX_LINE_BYTES:
            raise ProgramFailed(
                f"{self._what} wrote {len(self._rest)} bytes without the end of a line; end each answer with a line "
                "break"
            )
        lines = [line.decode(errors="replace").strip() for line in whole]
        lines = [line for line in lines if line]
        return lines if chunk or lines else None

    def _late(self, answered: int, questions: Sequence[str]) -> ProgramFailed:
        """Whether it holds its answers back is seen by closing its input: then they come."""
        with suppress(OSError):
            self._input.close()
        held, deadline = 0, time.monotonic() + CLOSING_TIMEOUT
        with selectors.DefaultSelector() as ready:
            ready.register(self._output, selectors.EVENT_READ)
            while answered + held < len(questions) and ready.select(max(0.0, deadline - time.monotonic())):
                found = self._lines()
                if found is None:
                    break
                held += len(found)
        self._kill()
        late = f"{self._what} did not write answer {answered + 1} of {len(questions)} within {self._time_limit:g} s"
        flush = "flush the output after each answer (C: fflush(stdout); C++: std::endl; Fortran: flush(6))"
        if held:
            return ProgramFailed(
                f"{late}, but wrote {held} more once its input was closed: it holds answers back; {flush}, or give "
                "--restart-after if it waits for more input, as Octave's fgetl does"
            )
        return ProgramFailed(
            f"{late}; if it does answer, {flush}, or give more time by --time-limit; the question was "
            f"'{questions[answered]}'{self._said()}"
        )

    def _ended(self, answered: int, questions: Sequence[str]) -> ProgramFailed:
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(CLOSING_TIMEOUT)
        still_runs = self._process.returncode is None
        code = self._kill()
        end = "closed its output" if still_runs else end_in_words(code)
        return ProgramFailed(
            f"{self._what} {end} after {answered} of {len(questions)} answers; the first question without one was "
            f"'{questions[answered]}'{self._said()}"
        )

    def _said(self) -> str:
        """The end of what it wrote to standard error."""
        self._errors.seek(0, os.SEEK_END)
        self._errors.seek(max(0, self._errors.tell() - MAX_REPEATED_ERROR))
        text = self._errors.read().decode(errors="replace").strip()
        return f"; on standard error: {text}" if text else "; it wrote nothing to standard error"


def end_in_words(code: int | None) -> str:
    """The end of a process in words. code: its exit code, or minus the number of a signal."""
    if code is None or code >= 0:
        return f"ended itself with exit code {code}"
    return f"was ended by signal {-code} ({signal.strsignal(-code)})"


def shown(line: str) -> str:
    """A line, shortened, in quotation marks."""
    return f"'{line}'" if len(line) <= MAX_REPEATED_LINE else f"'{line[: MAX_REPEATED_LINE - 1]}…'"


def _reason(program: str, error: OSError) -> str:
    """Why a program cannot be started, and what to do about it."""
    if isinstance(error, FileNotFoundError):
        if os.sep not in program and Path(program).is_file():
            return f"there is no program {program}; the file here is ./{program}"
        if Path(program).is_file():
            return f"what the first line of {program} names does not exist"
        return f"there is no program {program}"
    if isinstance(error, PermissionError) and shutil.which(program) is None:
        return f"{program} is no executable program; compile it, or chmod +x a script"
    if error.errno == ENOEXEC:
        return f"{program} is no program; begin with the one that runs it, such as 'octave-cli {program}'"
    return f"{error.strerror}"
