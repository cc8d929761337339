"""A robot's program, read line by line: only in the form in which programs are written here, or refused."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from crosscheck.recordings.errors import BadRecordingFile, quoted
from urdf.document import NUMBER

NAME = r"[A-Za-z_][A-Za-z0-9_]*"
"""Pattern of the name of a program."""


class LineForm(NamedTuple):
    """words: the line as a message writes it; pattern: of the whole line, numbers as groups"""

    words: str
    pattern: re.Pattern[str]

    @classmethod
    def of(cls, words: str, numbers: int = 0) -> LineForm:
        """The form of a line in which … stands for a number, as often as given, and NAME for a name."""
        assert words.count("…") == numbers
        return cls(words, re.compile(re.escape(words).replace("…", f"({NUMBER})").replace("NAME", NAME)))


class ProgramLines:
    """The lines of a file that are not blank, taken one after the other.

    Raises BadRecordingFile where the file is no text; OSError.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            text = path.read_text(encoding="utf-8-sig")
        except UnicodeDecodeError as error:
            raise BadRecordingFile(f"{path}: byte {error.start} is no UTF-8; give the program as text") from None
        numbered = enumerate((line.strip(" \t\r") for line in text.split("\n")), start=1)
        self._left = [(number, line) for number, line in numbered if line][::-1]

    def follows(self, form: LineForm) -> bool:
        """Whether the next line has this form."""
        return bool(self._left) and form.pattern.fullmatch(self._left[-1][1]) is not None

    def take(self, form: LineForm) -> list[float]:
        """The numbers of the next line. Raises BadRecordingFile for a line of another form."""
        if not self._left:
            raise BadRecordingFile(f"{self.path}: ends where {quoted(form.words)} is needed; give the whole program")
        if not self.follows(form):
            raise self.fault(f"{quoted(self._left[-1][1])} where {quoted(form.words)} is needed")
        match = form.pattern.fullmatch(self._left[-1][1])
        numbers = [float(text) for text in match.groups()] if match else []
        if not all(map(math.isfinite, numbers)):
            raise self.fault("a number beyond 1.8e308")
        self._left.pop()
        return numbers

    def take_all(self, forms: Iterable[LineForm]) -> None:
        """Pass lines of these forms. Raises BadRecordingFile for others."""
        for form in forms:
            self.take(form)

    def end(self) -> None:
        """Raises BadRecordingFile where lines are left."""
        if self._left:
            raise self.fault(f"{quoted(self._left[-1][1])} after the end of the program")

    def fault(self, problem: str) -> BadRecordingFile:
        """An error about the next line."""
        return BadRecordingFile(
            f"{self.path}: line {self._left[-1][0]}: {problem}; programs are read only in the form in which "
            "graphdyn excite --out writes them"
        )
