"""Options of every command that finds something: files for pipelines, and findings that are accepted.

accepted = options.accepted("inspect")          # before the work: a bad file is told at once
...
raise typer.Exit(deliver_findings("inspect", checks, report, options, accepted))
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.commands.program.options import JsonOptions
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.report.report import Note, Notes, Report, Section, Verdict
from graphdyn.errors import counted as numbered

if TYPE_CHECKING:
    from crosscheck.report.findings.checks import RobotCheck
    from crosscheck.report.findings.counted import CountedFindings
    from crosscheck.report.findings.waivers import Waiver
    from crosscheck.viewing.figures import Figure

MAX_TOLD = 3
"""Findings told in a headline; the report has all."""


@dataclass(frozen=True)
class AcceptedFindings:
    """baseline: file by fingerprint, of a SARIF file, None where none is given; waivers: of a TOML file"""

    baseline: Mapping[str, str] | None = None
    waivers: tuple[Waiver, ...] = ()

    @property
    def given(self) -> bool:
        return self.baseline is not None or bool(self.waivers)


@dataclass(frozen=True, kw_only=True)
class FindingOptions:
    """--sarif, --junit, --baseline and --waivers"""

    PANEL: ClassVar[str] = "Findings, for pipelines"

    sarif_file: Annotated[
        OutputFile | None,
        typer.Option(
            "--sarif", metavar="FILE", parser=OutputFile, help="Write findings as SARIF, which code scanning reads."
        ),
    ] = None
    junit_file: Annotated[
        OutputFile | None,
        typer.Option(
            "--junit", metavar="FILE", parser=OutputFile.tests, help="Write checks as JUnit XML, which CI systems read."
        ),
    ] = None
    baseline: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE", help="SARIF file written earlier: only findings that are not in it make the command fail."
        ),
    ] = None
    waivers: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="TOML file of findings that are accepted, with reasons (docs/ci.md)."),
    ] = None

    def refuse(self, why: str) -> None:
        """Raise typer.BadParameter for the first of these options that is given. why: after its name"""
        given = {
            "--sarif": self.sarif_file, "--junit": self.junit_file,
            "--baseline": self.baseline, "--waivers": self.waivers,
        }  # fmt: skip
        for option, value in given.items():
            if value is not None:
                raise typer.BadParameter(f"{option} {why}")

    def accepted(self, command: str) -> AcceptedFindings:
        """What --baseline and --waivers say to this command. Raises InvalidInput, OSError."""
        from crosscheck.report.findings.sarif import baseline_in
        from crosscheck.report.findings.waivers import read_waivers

        known = None
        if self.baseline is not None:
            known = baseline_in(self.baseline.read_bytes(), str(self.baseline), command)
        return AcceptedFindings(known, () if self.waivers is None else read_waivers(self.waivers, command))


def deliver_findings(
    command: str,
    checks: Sequence[RobotCheck],
    report: Report,
    options: FindingOptions,
    accepted: AcceptedFindings,
    figures: Callable[[], Sequence[Figure]] | None = None,
) -> int:
    """Write the files that options name, deliver the report, and return the exit code. figures: as for deliver

    Raises OSError.
    """
    from crosscheck.report.findings.counted import count
    from crosscheck.report.findings.junit import junit
    from crosscheck.report.findings.sarif import sarif

    counted = count(checks, accepted.baseline or {}, accepted.waivers, date.today())
    if options.sarif_file is not None:
        unwaived = [counted.findings[k] for k in sorted((*counted.new, *counted.known))]
        worth = [finding for finding in unwaived if finding.needs_action]
        options.sarif_file.write(sarif(command, worth, accepted.baseline))
    if options.junit_file is not None:
        options.junit_file.write(junit(command, checks, counted.forgiven))
    told = _told(report, counted, accepted) if accepted.given else report
    deliver(told, options if isinstance(options, JsonOptions) else None, figures)
    failing = counted.failing
    return BAD_INPUT if any(finding.bad_input for finding in failing) else DISAGREED if failing else AGREED


def _told(report: Report, counted: CountedFindings, accepted: AcceptedFindings) -> Report:
    """The report with the verdict on what is not accepted, and what is."""
    assert report.verdict is not None
    parts = [f"{len(counted.known)} in the baseline"] if counted.known else []
    parts += [f"{len(counted.waived)} waived"] if counted.waived else []
    said = f"Accepted: {', '.join(parts)}." if parts else "Nothing that was accepted was found."
    failing, before = counted.failing, report.verdict
    if failing:
        first = [f"{finding.place}: {finding.text}" for finding in failing[:MAX_TOLD]]
        more = [f"and {len(failing) - MAX_TOLD} more"] if len(failing) > MAX_TOLD else []
        kind = "new finding" if accepted.baseline is not None else "finding without waiver"
        verdict = Verdict("disagrees", _plural(len(failing), kind), f"{'; '.join([*first, *more])}. {said}")
    elif before.state == "agrees":
        verdict = replace(before, reason=f"{before.reason} {said}".strip())
    else:
        words = "nothing new" if accepted.baseline is not None else "every finding is waived"
        verdict = Verdict("agrees", words, f"{said} Without that: {before.words}.")
    section = Section("accepted", "Accepted findings", (Notes((*_waived(counted), *_without_effect(counted))),))
    return replace(report, verdict=verdict, sections=(*report.sections, section))


def _plural(number: int, kind: str) -> str:
    first, _, rest = kind.partition("finding")
    return f"{numbered(number, f'{first}finding')}{rest}"


def _waived(counted: CountedFindings) -> list[Note]:
    return [
        Note(f"{waiver.reason}{f' (until {waiver.until})' if waiver.until else ''}", finding.code, finding.element)
        for k, waiver in counted.waived
        for finding in [counted.findings[k]]
    ]


def _without_effect(counted: CountedFindings) -> list[Note]:
    """Waivers and parts of a baseline to be removed."""
    notes = [
        Note(f"{each.text} covers no finding here; remove it if that holds for all robots", state="undecided")
        for each in counted.unused
    ]
    notes += [
        Note(f"{each.text} ended on {each.until}: its findings count again; correct them, or state a later day",
             state="undecided")
        for each in counted.expired
    ]  # fmt: skip
    if counted.gone:
        gone = f"gone since the baseline: {numbered(counted.gone, 'finding')}; write it again, with --sarif"
        notes.append(Note(gone, state="undecided"))
    return notes
