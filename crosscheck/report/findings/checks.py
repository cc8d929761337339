"""What a command checks of each robot, and what it finds: what SARIF and JUnit files are made of.

A command makes its checks of its result, as it makes its report.
"""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Literal
from urllib.parse import quote

Level = Literal["error", "warning", "note"]

NEVER_FORGIVEN = ("no-such-file", "unreadable-file")
"""Codes that neither a baseline nor a waiver forgives: nothing was looked at."""


@dataclass(frozen=True)
class CommandFinding:
    """One fault, oddity or disagreement, and where to look.

    code: stable name of its kind; element: link, joint, quantity or function that it is about, "" for all of the robot
    file, line: the place, the first line where none is known
    message, remedy: what is there, and what to do; remedy is "" where nothing needs to be done
    fails: whether it makes the command fail; bad_input: with the exit code of bad input
    """

    code: str
    level: Level
    robot: str
    element: str
    file: str
    line: int
    message: str
    remedy: str = ""
    fails: bool = False
    bad_input: bool = False

    @property
    def text(self) -> str:
        """Element, message and remedy in one line."""
        said = f"{self.element}: {self.message}" if self.element else self.message
        return f"{said} → {self.remedy}" if self.remedy else said

    @property
    def needs_action(self) -> bool:
        """Whether it is worth a line beside the code: notes only of elements to be changed. The report has all."""
        return self.level != "note" or bool(self.remedy and self.element)

    @property
    def place(self) -> str:
        """ "robots/arm.urdf:12" """
        return f"{path_here(self.file)}:{self.line}"


@dataclass(frozen=True)
class RobotCheck:
    """One question about one robot. skipped: why it was not asked, "" if it was"""

    robot: str
    name: str
    findings: tuple[CommandFinding, ...] = ()
    skipped: str = ""


def all_findings(checks: Iterable[RobotCheck]) -> list[CommandFinding]:
    """The findings of all checks, in their order."""
    return [finding for check in checks for finding in check.findings]


def fingerprints(findings: Sequence[CommandFinding]) -> list[str]:
    """What tells the findings apart, in one version of a file and the next: code, element and file, not the line.

    Those of one code, element and file are numbered in their order. Paths are relative to the working folder; of a file
    elsewhere, such as a robot of the catalog, the name counts.
    """
    seen: Counter[str] = Counter()
    found = []
    for finding in findings:
        relative = _below(finding.file)
        file = Path(finding.file).name if relative is None else relative
        key = sha256("\0".join((finding.code, finding.element, file)).encode(errors="replace")).hexdigest()[:16]
        seen[key] += 1
        found.append(f"{key}:{seen[key]}")
    return found


def uri(file: str) -> str:
    """Relative to the working folder for a file below it, as code scanning needs it; else with its whole path."""
    relative = _below(file)
    return Path(os.path.abspath(file)).as_uri() if relative is None else quote(os.fsencode(relative))


def path_here(file: str) -> str:
    """The file as one names it in the working folder."""
    return _below(file) or file


def _below(file: str) -> str | None:
    path, here = Path(os.path.abspath(file)), Path.cwd()
    return path.relative_to(here).as_posix() if path.is_relative_to(here) else None
