"""Robots that a command could not look at, and why, as its JSON file and its findings tell it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from crosscheck.report.findings.checks import CommandFinding, RobotCheck

Failure = dict[str, Any]
"""robot, message, code, file, line; the last two may be None."""


def failure(robot: str, error: Exception | str, code: str = "not-compared") -> Failure:
    """The robot, the message, and of an error of urdf its code and place. code: of what has none"""
    if isinstance(error, OSError):
        code = "unreadable-file"
    file, line = getattr(error, "path", None), getattr(error, "line", None)
    return {
        "robot": robot,
        "message": str(error),
        "code": getattr(error, "code", code),
        "file": None if file is None else str(file),
        "line": line,
    }


def failed_check(failed: Mapping[str, Any], name: str) -> RobotCheck:
    """The check that could not be made. name: of the check"""
    robot, file, line = failed["robot"], failed["file"] or failed["robot"], failed["line"] or 1
    finding = CommandFinding(
        failed["code"], "error", robot, "", file, line, failed["message"], fails=True, bad_input=True
    )
    return RobotCheck(robot, name, (finding,))
