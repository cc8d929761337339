"""Which findings count: neither those of a baseline nor waived ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date

from crosscheck.report.findings.checks import (
    NEVER_FORGIVEN,
    CommandFinding,
    RobotCheck,
    all_findings,
    fingerprints,
    uri,
)
from crosscheck.report.findings.waivers import Waiver


@dataclass(frozen=True)
class CountedFindings:
    """The findings of all checks, sorted out.

    new: those that count, by their numbers; known: those of the baseline; waived: by which waiver
    gone: number of the findings of the baseline, about files that were looked at, that are no longer there
    unused, expired: waivers without effect: no finding in the files that were looked at, or too late
    """

    checks: tuple[RobotCheck, ...]
    findings: tuple[CommandFinding, ...]
    new: tuple[int, ...]
    known: tuple[int, ...]
    waived: tuple[tuple[int, Waiver], ...]
    gone: int
    unused: tuple[Waiver, ...]
    expired: tuple[Waiver, ...]

    @property
    def failing(self) -> list[CommandFinding]:
        """The findings that make the command fail."""
        return [self.findings[k] for k in self.new if self.findings[k].fails]

    @property
    def forgiven(self) -> dict[int, str]:
        """Why a finding does not count, by its number."""
        return {
            **dict.fromkeys(self.known, "in the baseline"),
            **{k: f"waived: {waiver.reason}" for k, waiver in self.waived},
        }


def count(
    checks: Sequence[RobotCheck], baseline: Mapping[str, str], waivers: Sequence[Waiver], today: date
) -> CountedFindings:
    """baseline: file by fingerprint; today: by which waivers expire"""
    findings = all_findings(checks)
    prints = fingerprints(findings)
    valid = [waiver for waiver in waivers if not waiver.expired(today)]
    new, known, waived = [], [], []
    for k, finding in enumerate(findings):
        waiver = next((waiver for waiver in valid if waiver.covers(finding)), None)
        if waiver is not None:
            waived.append((k, waiver))
        elif prints[k] in baseline and finding.code not in NEVER_FORGIVEN:
            known.append(k)
        else:
            new.append(k)
    files = {check.robot for check in checks} | {finding.file for finding in findings}
    unused = [
        waiver
        for waiver in valid
        if any(map(waiver.is_about, files)) and not any(waiver.covers(finding) for finding in findings)
    ]
    seen = set(map(uri, files))
    return CountedFindings(
        tuple(checks),
        tuple(findings),
        tuple(new),
        tuple(known),
        tuple(waived),
        sum(file in seen for mark, file in baseline.items() if mark not in prints),
        tuple(unused),
        tuple(waiver for waiver in waivers if waiver.expired(today)),
    )
