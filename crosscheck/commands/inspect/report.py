"""`graphdyn inspect`: what is odd or wrong in one URDF file or in many, as a report."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any

import urdf
from crosscheck.commands.inspect.record import record as inspect_record
from crosscheck.commands.program.repair_commands import proposed
from crosscheck.report.report import (
    Block,
    Code,
    Column,
    Facts,
    Group,
    Note,
    Notes,
    Recorder,
    Report,
    Row,
    Section,
    State,
    Table,
    Verdict,
)
from graphdyn.errors import counted

MAX_NAMED_ELEMENTS = 3
"""Elements named per kind of finding; the page has all below the table."""

MAX_REASONS = 3
"""Kinds of findings told as reasons of a verdict; the table has all."""

MAX_LISTED_CODES = 4
"""Codes told per file in the table of several."""

MAX_UNFOLDED_FILES = 20
"""Files good for dynamics from which their table is folded."""

SEVERITY_VERDICTS: dict[str, State] = {"error": "disagrees", "warning": "undecided", "note": "plain"}

FILE_VERDICTS: dict[str, tuple[State, str, str]] = {
    "refused": ("disagrees", "refused", "Cannot be loaded"),
    "kinematics only": ("undecided", "good for kinematics only", "Torques do not determine accelerations"),
    "dynamics": ("agrees", "good for dynamics", "Dynamics can be computed"),
}
"""Per verdict, the worst first: how it looks, in words, and what it means."""


def inspect_report(inspected: Sequence[urdf.Inspection], failures: Sequence[Mapping[str, Any]]) -> Report:
    """Every finding of one file, or several files by their verdicts.

    failures: what could not be found: robot, message
    """
    missing = Notes(
        tuple(Note(failure["message"], where=failure["robot"], state="disagrees") for failure in failures),
        title="Could not be inspected",
        on=("page",),
    )
    record = partial(inspect_record, inspected, occurrences(inspected), failures)
    return _one(inspected[0], missing, record) if len(inspected) == 1 else _several(inspected, missing, record)


def occurrences(inspected: Sequence[urdf.Inspection]) -> dict[str, int]:
    """Occurrences by code, the number of files that have it, most frequent first."""
    return dict(Counter(code for file in inspected for code in file.codes).most_common())


def worst(file: urdf.Inspection) -> list[str]:
    """The first codes of the worst severity there is, notes left out."""
    codes = [
        dict.fromkeys(f.code for f in file.findings if f.severity == severity) for severity in ("error", "warning")
    ]
    return list(next((found for found in codes if found), {}))[:MAX_LISTED_CODES]


def _one(file: urdf.Inspection, missing: Notes, record: Recorder) -> Report:
    state, words, meaning = FILE_VERDICTS[file.verdict]
    told = [kind[0].text for kind in _kinds(file.findings) if kind[0].text in file.reasons][:MAX_REASONS]
    more = [f"and {len(file.reasons) - len(told)} more"] if len(file.reasons) > len(told) else []
    reason = f"{_counts(file)}: {'; '.join([*told, *more])}" if told else f"{meaning} ({_counts(file)})"
    if file.usable and file.improbable:
        state, words, reason = (
            "undecided",
            f"{words}, with improbable numbers",
            f"{reason}. Improbable: {_first_of(file.improbable)}",
        )
    verdict = Verdict(state, words, reason, f"The file is {words}.")
    if missing.notes:
        words += f"; {len(missing.notes)} more could not be inspected"
        verdict = Verdict("disagrees", words, reason, f"The file is {words}.")
    return Report(
        Path(file.robot).name,
        verdict,
        (Section("findings", "", (missing, *_findings(file), *_repairs(file))),),
        record=record,
    )


def _first_of(texts: Sequence[str]) -> str:
    more = f"; and {len(texts) - 1} more" if len(texts) > 1 else ""
    return f"{texts[0]}{more}"


def _repairs(file: urdf.Inspection) -> Iterator[Code]:
    """The commands that mend what can be mended."""
    if commands := proposed(file):
        yield Code("\n".join(commands), title="Repair by")


def _several(inspected: Sequence[urdf.Inspection], missing: Notes, record: Recorder) -> Report:
    folder = _common_folder([file.robot for file in inspected])
    by_verdict = {
        verdict: files
        for verdict in FILE_VERDICTS
        if (files := [file for file in inspected if file.verdict == verdict])
    }
    number = [f"{len(files)} {FILE_VERDICTS[verdict][1]}" for verdict, files in by_verdict.items()]
    number += [f"{len(missing.notes)} could not be inspected"] if missing.notes else []
    state = "disagrees" if missing.notes else FILE_VERDICTS[next(iter(by_verdict))][0]
    often = Table(
        (Column("finding", "name"), Column("files", "number")),
        tuple(Row((code, count)) for code, count in occurrences(inspected).items()),
        title="How many files have each finding",
        folded=True,
    )
    return Report(
        f"{len(inspected)} robot files",
        Verdict(
            state,
            ", ".join(number),
            f"In the folder {folder}." if folder else "",
            _sentence(len(missing.notes), {verdict: len(files) for verdict, files in by_verdict.items()}),
        ),
        (
            *([Section("missing", "", (missing,))] if missing.notes else []),
            *(_of_verdict(verdict, files, folder) for verdict, files in by_verdict.items()),
            *([Section("occurrences", "", (often,))] if inspected else []),
        ),
        record=record,
    )


def _sentence(missing: int, by_verdict: Mapping[str, int]) -> str:
    """by_verdict: files of each verdict, the worst first"""
    number = missing + sum(by_verdict.values())
    parts = [f"{n} {'is' if n == 1 else 'are'} {FILE_VERDICTS[verdict][1]}" for verdict, n in by_verdict.items()]
    parts += [f"{missing} could not be inspected"] if missing else []
    if len(parts) == 1:
        return f"Of {number} robot files, all {parts[0].split(' ', 1)[1]}."
    return f"Of {number} robot files, {', '.join(parts[:-1])} and {parts[-1]}."


def _of_verdict(verdict: str, files: Sequence[urdf.Inspection], folder: str) -> Section:
    """The files of one verdict in a table, and the findings of each of them."""
    state, words, meaning = FILE_VERDICTS[verdict]
    key = verdict.replace(" ", "-")
    names = [os.path.relpath(file.robot, folder) if folder else file.robot for file in files]
    many = verdict == "dynamics" and len(files) > MAX_UNFOLDED_FILES
    table = Table(
        (
            Column("file", "name"),
            *(Column(f"{severity}s", "number") for severity in SEVERITY_VERDICTS),
            Column("worst findings", meaning="codes of the worst severity, notes left out"),
        ),
        tuple(
            Row((name, *map(file.count, SEVERITY_VERDICTS), ", ".join(worst(file))), link=f"{key}-{k}")  # type: ignore[arg-type]
            for k, (name, file) in enumerate(zip(names, files, strict=True), start=1)
        ),
        title="The files" if many else "",
        folded=many,
    )
    details = tuple(
        Group(_findings(file), title=f"{name}: {_counts(file)}", folded=True, key=f"{key}-{k}")
        for k, (name, file) in enumerate(zip(names, files, strict=True), start=1)
    )
    findings = Group(details, title="Findings of each file", folded=True, on=("page",))
    number = counted(len(files), "file")
    return Section(key, words.capitalize(), (table, findings), Verdict(state, number, f"{meaning}."))


def _findings(file: urdf.Inspection) -> tuple[Block, ...]:
    """A row per kind of finding, and each finding of the kinds that occur more than once."""
    kinds = _kinds(file.findings)
    table = Table(
        (
            Column("severity", "verdict"),
            Column("finding", "name"),
            Column("where"),
            Column("what, and what to do"),
        ),
        tuple(_kind_row(kind) for kind in kinds),
    )
    every = Notes(
        tuple(
            Note(f"{one.message} → {one.remedy}", one.code, _place(one), SEVERITY_VERDICTS[one.severity])
            for kind in kinds
            if len(kind) > 1
            for one in kind
        ),
        title="Every finding of the kinds that occur more than once",
        folded=True,
        on=("page",),
    )
    return Facts((("file", file.path or file.robot),)), table, every


def _kinds(findings: Sequence[urdf.Finding]) -> list[list[urdf.Finding]]:
    """The findings by severity and code, in the order of the first of each."""
    order = {(f.severity, f.code): k for k, f in reversed(list(enumerate(findings)))}
    by_kind = sorted(findings, key=lambda f: order[f.severity, f.code])
    return [list(kind) for _, kind in groupby(by_kind, lambda f: (f.severity, f.code))]


def _kind_row(kind: Sequence[urdf.Finding]) -> Row:
    first, state = kind[0], SEVERITY_VERDICTS[kind[0].severity]
    number = f" {len(kind)}×" if len(kind) > 1 else ""
    more = [f"and {len(kind) - MAX_NAMED_ELEMENTS} more"] if len(kind) > MAX_NAMED_ELEMENTS else []
    places = "\n".join([*map(_place, kind[:MAX_NAMED_ELEMENTS]), *more])
    said = f"{first.message}\n→ {first.remedy}"
    return Row((Verdict(state, first.severity), f"{first.code}{number}", places, said), state)


def _place(finding: urdf.Finding) -> str:
    """ "<mass> of link 'wrist', line 12", and of which file, if not of the inspected one."""
    line = f"line {finding.line}" if finding.line else ""
    file = f"{line} of {finding.file}" if finding.file and line else finding.file or line
    return ", ".join(part for part in (finding.element, file) if part)


def _counts(file: urdf.Inspection) -> str:
    numbers = {severity: file.count(severity) for severity in SEVERITY_VERDICTS}  # type: ignore[arg-type]
    return ", ".join(counted(number, severity) for severity, number in numbers.items())


def _common_folder(robots: Sequence[str]) -> str:
    """The folder that all are in; empty where there is none."""
    try:
        return os.path.commonpath([os.path.dirname(robot) for robot in robots])
    except ValueError:  # none, names, or absolute and relative paths
        return ""
