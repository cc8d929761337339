"""A program, or a C function of a library, as a function under test: it reads states as lines and writes answers."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from crosscheck.judging.exchange import library_process
from crosscheck.judging.exchange.line_process import LineProcess, ProgramFailed
from crosscheck.judging.exchange.printed_numbers import UnreadableAnswer
from crosscheck.judging.exchange.protocols import PROTOCOLS_BY_NAME, Protocol, Shape
from crosscheck.quantities.tested_function import Refusal
from graphdyn.layout import Array


class ProgramFunction:
    """A function under test that a program computes. It runs from the first question to close(), or once per batch.

    command: name of the program and its arguments; what: its name in messages
    time_limit: of each answer [s]
    restart_after: number of questions after which the input is closed and the program started anew; None for never
    """

    def __init__(
        self, command: Sequence[str], what: str, protocol: Protocol, time_limit: float, restart_after: int | None = None
    ):
        self._command, self._what, self._protocol = command, what, protocol
        self._time_limit, self._restart_after = time_limit, restart_after
        self._process: LineProcess | None = None
        self._asked = 0

    def answers(self, function: str, states: Sequence[Mapping[str, Array]], shape: Shape) -> list[Array | Refusal]:
        """The answer (shape) at each state. states: arguments by name. Raises ProgramFailed."""
        size = self._restart_after or len(states)
        found: list[Array | Refusal] = []
        for start in range(0, len(states), size):
            found += self._of_batch(function, states[start : start + size], shape)
        return found

    def _of_batch(self, function: str, states: Sequence[Mapping[str, Array]], shape: Shape) -> list[Array | Refusal]:
        if self._process is None:
            self._process = LineProcess(self._command, self._what, self._time_limit)
        numbers = range(self._asked + 1, self._asked + len(states) + 1)
        ask = self._protocol.question
        questions = [ask(k, function, state, shape) for k, state in zip(numbers, states, strict=True)]
        lines = self._process.answers(questions, last=self._restart_after is not None)
        self._asked += len(states)
        if self._restart_after is not None:
            self.close()
        return [self._read(line, k, shape) for k, line in zip(numbers, lines, strict=True)]

    def _read(self, line: str, number: int, shape: Shape) -> Array | Refusal:
        try:
            return self._protocol.answer(line, number, shape)
        except UnreadableAnswer as error:
            raise ProgramFailed(
                f"{self._what}: answer {number} is {error}; write answers alone to standard output, and everything "
                "else to standard error"
            ) from None

    def close(self) -> None:
        """End the program, if it runs."""
        if self._process is not None:
            self._process.close()
            self._process = None

    def __enter__(self) -> ProgramFunction:
        return self

    def __exit__(self, *_raised: object) -> None:
        self.close()


def library_function(file: Path, symbol: str, time_limit: float) -> ProgramFunction:
    """int symbol(int n, const double *q, const double *v, const double *a, double *tau), and so on: n joints, the
    arguments in their order, room for the answer, a matrix row by row. It returns 0 where the answer is valid.

    time_limit: of each answer [s]
    """
    command = [sys.executable, "-I", library_process.__file__, str(file.resolve()), symbol]
    return ProgramFunction(command, f"the process that calls {file}:{symbol}", PROTOCOLS_BY_NAME["json"], time_limit)
