"""What an inspection finds, in words; the report of all of it."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from lxml import etree

from graphdyn.display import Displayed
from graphdyn.errors import counted
from graphdyn.tables import data_frame
from urdf.document.elements import describe, file_of, line_of
from urdf.errors import URDFError, one_line
from urdf.inspection.remedies import OTHER_READERS, REMEDIES

if TYPE_CHECKING:
    import pandas

Severity = Literal["error", "warning", "note"]
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")
"""Severities in this order: urdf.load refuses the file; it loads, but its dynamics are doubtful; good to know."""

Verdict = Literal["dynamics", "kinematics only", "refused"]

MAX_SUMMARIZED = 6
"""Findings that the text of an inspection tells."""

NO_FORWARD_DYNAMICS = ("mass-matrix-singular", "mass-matrix-indefinite", "loop-cannot-close", "infinitesimal-mobility")
"""Codes of the findings that leave a robot fit for kinematics only."""

IMPROBABLE = (
    *("effort-below-gravity", "far-center-of-mass", "gyration-radius", "heavy-link", "inconsistent-body"),
    *("indefinite-inertia", "inertia-across-link", "inertial-density", "mesh-density", "miswritten-inertia"),
    *("other-density", "placeholder-inertials", "suspicious-lengths", "suspicious-masses", "triangle-inequality"),
)
"""Codes of the warnings about numbers that no arm has, or hardly any."""


@dataclass(frozen=True)
class Finding:
    """One fault or oddity.

    code: stable name of its kind ("negative-mass")
    severity: error: urdf.load refuses the file; warning: it loads, its dynamics are doubtful; note: good to know
    element: "link 'wrist'", "<mass> of link 'wrist'"; None for the file as a whole
    line: in the file, from 1; None where it is not known
    file: where the line is, if not in the inspected file: one that it includes, or one beside it
    message: what is there, and what Pinocchio and yourdfpy do with it; remedy: what to do about it
    """

    code: str
    severity: Severity
    element: str | None
    line: int | None
    message: str
    remedy: str
    file: str | None = None

    @property
    def place(self) -> str:
        """Such as "arm.xacro, line 3: "; empty where the line is not known."""
        file = f"{self.file}, " if self.file else ""
        return f"{file}line {self.line}: " if self.line else ""

    @property
    def text(self) -> str:
        """Element and message in one sentence."""
        return self.message if self.element is None else f"{self.element}: {self.message}"


@dataclass(frozen=True, repr=False)
class Inspection(Displayed):
    """All findings of one file.

    robot: path or name as given; path: of the file, None where there is none
    findings: errors, warnings, notes, each in the order of the file
    """

    robot: str
    path: str | None
    findings: tuple[Finding, ...]

    def summary(self) -> str:
        """The verdict, and the kinds of findings by severity."""
        counts = ", ".join(counted(self.count(severity), severity) for severity in SEVERITIES)
        worst = [f"{one.place}{one.text} [{one.code}]" for one in self.findings if one.severity != "note"]
        more = [f"and {len(worst) - MAX_SUMMARIZED} more"] if len(worst) > MAX_SUMMARIZED else []
        return "\n".join([f"{self.robot}: {self.verdict}; {counts}", *worst[:MAX_SUMMARIZED], *more])

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every finding: severity, code, file, line, element, message and remedy.

        Raises ImportError where pandas is missing.
        """
        names = ("severity", "code", "file", "line", "element", "message", "remedy")
        return data_frame({name: [getattr(one, name) for one in self.findings] for name in names})

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
    def improbable(self) -> tuple[str, ...]:
        """The warnings about numbers that no arm has, or hardly any."""
        return tuple(one.text for one in self.findings if one.severity == "warning" and one.code in IMPROBABLE)

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
    here = [replace(finding, file=None) if finding.file in (path, robot) else finding for finding in findings]
    named = [replace(each, remedy=each.remedy.replace("{robot}", shlex.quote(robot))) for each in here]
    in_order = sorted(named, key=lambda each: (SEVERITIES.index(each.severity), each.file or "", each.line or 0))
    return Inspection(robot, path, tuple(in_order))


def found(
    code: str,
    problem: str,
    element: str | None,
    line: int | None,
    file: str | None,
    severity: Severity | None = None,
) -> Finding:
    """A finding of REMEDIES. severity: for codes that have several; by default the highest of the code."""
    possible = [one for one in SEVERITIES if code in REMEDIES[one]]
    severity = severity or possible[0]
    return Finding(code, severity, element, line, told(code, problem), REMEDIES[severity][code], file)


def about(code: str, element: etree._Element, problem: str, severity: Severity | None = None) -> Finding:
    """A finding about an element."""
    return found(code, problem, describe(element), line_of(element), file_of(element), severity)


def of_file(
    code: str,
    problem: str,
    line: int | None = None,
    severity: Severity | None = None,
    at: etree._Element | None = None,
) -> Finding:
    """A finding about the file as a whole; line, or at: the first place."""
    if at is None:
        return found(code, problem, None, line, None, severity)
    return found(code, problem, None, line_of(at), file_of(at), severity)


def refusal(error: URDFError) -> Finding:
    """What urdf.load raises, as a finding."""
    file = None if error.path is None else str(error.path)
    return Finding(error.code, "error", error.element, error.line, told(error.code, error.problem), error.remedy, file)


def told(code: str, problem: str) -> str:
    """The problem on one line, and what Pinocchio and yourdfpy do."""
    problem = one_line(problem)
    return f"{problem}. {OTHER_READERS[code]}" if code in OTHER_READERS else problem
