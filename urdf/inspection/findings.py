"""What an inspection finds, and the report of all of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Severity = Literal["error", "warning", "note"]
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")
"""Severities in this order: urdf.load refuses the file; it loads, but its dynamics are doubtful; good to know."""

Verdict = Literal["dynamics", "kinematics only", "refused"]

NO_FORWARD_DYNAMICS = ("mass-matrix-singular", "mass-matrix-indefinite", "loop-cannot-close")
"""Codes of the findings that leave a robot fit for kinematics only."""


@dataclass(frozen=True)
class Finding:
    """One fault or oddity.

    code: stable name of its kind ("negative-mass")
    severity: error: urdf.load refuses the file; warning: it loads, its dynamics are doubtful; note: good to know
    element: "link 'wrist'", "<mass> of link 'wrist'"; None for the file as a whole
    line: in the file, from 1; None where it is not known
    message: what is there, and what Pinocchio and yourdfpy do with it; remedy: what to do about it
    """

    code: str
    severity: Severity
    element: str | None
    line: int | None
    message: str
    remedy: str

    @property
    def text(self) -> str:
        """Element and message in one sentence."""
        return self.message if self.element is None else f"{self.element}: {self.message}"


@dataclass(frozen=True)
class Inspection:
    """All findings of one file.

    robot: path or name as given; path: of the file, None where there is none
    findings: errors, warnings, notes, each in the order of the file
    """

    robot: str
    path: str | None
    findings: tuple[Finding, ...]

    @property
    def verdict(self) -> Verdict:
        """ "refused": urdf.load raises; "kinematics only": torques do not determine accelerations; else "dynamics"."""
        if self.count("error"):
            return "refused"
        return "kinematics only" if self.reasons else "dynamics"

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the verdict is not "dynamics"; empty where it is."""
        errors = [finding.text for finding in self.findings if finding.severity == "error"]
        return tuple(errors) or tuple(finding.text for finding in self.findings if finding.code in NO_FORWARD_DYNAMICS)

    @property
    def usable(self) -> bool:
        """Fit for dynamics."""
        return self.verdict == "dynamics"

    @property
    def codes(self) -> tuple[str, ...]:
        """Each code once, in the order of the findings."""
        return tuple(dict.fromkeys(finding.code for finding in self.findings))

    def count(self, severity: Severity) -> int:
        """Number of findings of this severity."""
        return sum(finding.severity == severity for finding in self.findings)


def report(robot: str, path: str | None, findings: list[Finding]) -> Inspection:
    """The report of these findings: by severity, then by line, those of the whole file first."""
    in_order = sorted(findings, key=lambda finding: (SEVERITIES.index(finding.severity), finding.line or 0))
    return Inspection(robot, path, tuple(in_order))
