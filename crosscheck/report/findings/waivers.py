"""Waivers: findings that the maintainers of a robot accept, with the reason, in a TOML file.

    [[waiver]]
    code = "heavy-link"
    element = "link 'base'"
    reason = "cast iron, 41 kg by the data sheet"
    until = 2027-06-30

A waiver is for one command, `inspect` unless it says `command = "crosscheck"`.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import date, datetime
from pathlib import Path, PurePosixPath
from typing import Any

from crosscheck.report.findings.checks import NEVER_FORGIVEN, CommandFinding, path_here
from graphdyn import InvalidInput
from urdf.document import toml_document

ENTRIES = ("code", "element", "file", "command", "reason", "until")


@dataclass(frozen=True)
class Waiver:
    """code, reason, command: as written; element, file: "" for any; file may be a pattern such as "robots/*.urdf"

    until: the last day on which it counts, None for always; number: in its file, from 1
    """

    code: str
    reason: str
    element: str
    file: str
    command: str
    until: date | None
    number: int

    def covers(self, finding: CommandFinding) -> bool:
        """Whether it speaks of this finding, expired or not."""
        return (
            finding.code == self.code
            and finding.code not in NEVER_FORGIVEN
            and self.element in ("", finding.element)
            and self.is_about(finding.file)
        )

    def is_about(self, file: str) -> bool:
        """Whether it may speak of findings in this file."""
        return not self.file or PurePosixPath(path_here(file)).match(self.file)

    def expired(self, today: date) -> bool:
        return self.until is not None and today > self.until

    @property
    def text(self) -> str:
        """ "waiver 2 (heavy-link, link 'base')" """
        return f"waiver {self.number} ({', '.join(part for part in (self.code, self.element, self.file) if part)})"


def read_waivers(path: Path, command: str) -> tuple[Waiver, ...]:
    """The waivers for a command. Raises InvalidInput, which names file, entry and remedy; OSError."""
    try:
        document = toml_document(path.read_bytes())
    except ValueError as error:
        raise InvalidInput(f"{path}: {error}") from None
    entries = document.get("waiver", [])
    unknown = sorted(set(document) - {"waiver"})
    if unknown or not isinstance(entries, list) or not all(isinstance(entry, dict) for entry in entries):
        said = f"knows no '{unknown[0]}'" if unknown else "'waiver' is no list of tables"
        raise InvalidInput(f"{path}: {said}; write each waiver below a line [[waiver]]")
    waivers = [_waiver(path, number, entry) for number, entry in enumerate(entries, start=1)]
    return tuple(waiver for waiver in waivers if waiver.command == command)


def _waiver(path: Path, number: int, entry: dict[str, Any]) -> Waiver:
    def refuse(problem: str, remedy: str) -> InvalidInput:
        return InvalidInput(f"{path}: waiver {number}: {problem}; {remedy}")

    for name in entry:
        if name not in ENTRIES:
            raise refuse(f"knows no '{name}'", f"give {', '.join(ENTRIES)}")
    for name in ("code", "reason"):
        if name not in entry:
            remedy = "write why the finding is accepted" if name == "reason" else "write the code of the finding"
            raise refuse(f"'{name}' is missing", remedy)
    for name in ("code", "reason", "element", "file", "command"):
        if name in entry and not (isinstance(entry[name], str) and entry[name].strip()):
            raise refuse(f"'{name}' is no text, or empty", f'write {name} = "…"')
    until = entry.get("until")
    if until is not None and (not isinstance(until, date) or isinstance(until, datetime)):
        raise refuse("'until' is no date", "write the last day without quotes, such as until = 2027-06-30")
    element, file = entry.get("element", ""), entry.get("file", "")
    return Waiver(entry["code"], entry["reason"], element, file, entry.get("command", "inspect"), until, number)
