"""What becomes of a damaged file, and what nothing may do that reads it."""

from __future__ import annotations

import os
import tempfile
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

OUTCOMES = ("refused", "agrees", "kinematics only", "explained", "unexpected")


@dataclass(frozen=True)
class Trial:
    """What became of a file. codes: of the refusal, or of the findings that explain; detail: of the unexpected."""

    outcome: str
    codes: tuple[str, ...] = ()
    detail: str = ""


@dataclass(frozen=True)
class Result:
    """A mutant, by format and number of a seed, what was done to the file, and what became of it."""

    format: str
    number: int
    kinds: tuple[str, ...]
    trial: Trial


class Unexpected(Exception):
    """A fault of this project."""


def tried(trial: Callable[[Path], Trial], path: Path) -> Trial:
    """What a trial says of a file. Warnings that it does not expect are faults, as all errors but Unexpected are."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return trial(path)
    except Unexpected as fault:
        return Trial("unexpected", detail=str(fault))
    except Exception as error:
        return Trial("unexpected", detail=f"{type(error).__name__}: {error} {_place(error)}")


def _place(error: BaseException) -> str:
    """File and line where it was raised."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return "" if trace is None else f"({trace.tb_frame.f_code.co_filename}:{trace.tb_lineno})"


@contextmanager
def quiet(who: str) -> Iterator[None]:
    """Writing to standard output or error, from Python or C++, is a fault."""
    with captured() as written:
        yield
    if written:
        raise Unexpected(f"{who} writes {written}")


@contextmanager
def captured() -> Iterator[list[str]]:
    """Keeps what is written to standard output and error; at the end the list holds its lines."""
    written: list[str] = []
    kept = [os.dup(number) for number in (1, 2)]
    with tempfile.TemporaryFile() as file:
        for number in (1, 2):
            os.dup2(file.fileno(), number)
        try:
            yield written
        finally:
            for number, copy in zip((1, 2), kept, strict=True):
                os.dup2(copy, number)
                os.close(copy)
            file.seek(0)
            written += file.read().decode(errors="replace").splitlines()
