"""The checks of `graphdyn inspect`: a check per robot and kind of finding, for the files of pipelines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

from crosscheck.report.findings.checks import CommandFinding, RobotCheck
from crosscheck.report.findings.failures import failed_check
from urdf import Finding, Inspection
from urdf.inspection import NOTHING


def inspect_checks(
    inspected: Sequence[Inspection], failures: Sequence[Mapping[str, Any]], fail_on: Literal["error", "warning"]
) -> list[RobotCheck]:
    """failures: arguments that stand for no file; fail_on: the least severity that fails the command"""
    checks = [check for file in inspected for check in _of_file(file, fail_on)]
    return [*checks, *(failed_check(failed, "found") for failed in failures)]


def _of_file(file: Inspection, fail_on: str) -> Iterator[RobotCheck]:
    reasons = set(file.reasons)
    for code in file.codes:
        found = (finding for finding in file.findings if finding.code == code)
        yield RobotCheck(
            file.robot, code, tuple(_finding(file, finding, finding.text in reasons, fail_on) for finding in found)
        )
    if not file.codes:
        yield RobotCheck(file.robot, "inspected")


def _finding(file: Inspection, finding: Finding, decides: bool, fail_on: str) -> CommandFinding:
    """decides: whether it leaves the file unfit for dynamics; then it is an error here, whatever its severity"""
    return CommandFinding(
        finding.code,
        "error" if decides else finding.severity,
        file.robot,
        finding.element or "",
        finding.file or file.path or file.robot,
        finding.line or 1,
        finding.message,
        "" if finding.remedy.startswith(NOTHING) else finding.remedy,
        fails=decides or (fail_on == "warning" and finding.severity == "warning"),
        bad_input=finding.code == "unreadable-file",
    )
