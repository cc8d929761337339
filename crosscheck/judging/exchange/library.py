"""A C function of a shared library as a function under test, called in a process that it may end."""

from __future__ import annotations

import sys
from pathlib import Path

from crosscheck.judging.exchange import library_process
from crosscheck.judging.exchange.program import ProgramFunction
from crosscheck.judging.exchange.protocols import PROTOCOLS_BY_NAME


def library_function(file: Path, symbol: str, time_limit: float) -> ProgramFunction:
    """int symbol(int n, const double *q, const double *v, const double *a, double *tau), and so on: n joints, the
    arguments in their order, room for the answer, a matrix row by row. It returns 0 where the answer is valid.

    time_limit: of each answer [s]
    """
    command = [sys.executable, "-I", library_process.__file__, str(file.resolve()), symbol]
    return ProgramFunction(command, f"the process that calls {file}:{symbol}", PROTOCOLS_BY_NAME["json"], time_limit)
