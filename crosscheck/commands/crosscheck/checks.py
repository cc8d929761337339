"""The checks of `graphdyn crosscheck`: a check per robot and quantity, for the files of pipelines.

They are made of the records of the JSON file, which a sweep may have taken over from an earlier one.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from crosscheck.report.findings.checks import CommandFinding, RobotCheck
from crosscheck.report.findings.failures import failed_check

DISAGREEMENT_REMEDY = "reproduce it by the code on the page of --html, and inspect the file: graphdyn inspect"


def crosscheck_checks(records: Sequence[Mapping[str, Any]], failures: Sequence[Mapping[str, Any]]) -> list[RobotCheck]:
    """records: of the robots that were compared; failures: of the others"""
    checks = [check for record in records for check in _of_robot(record)]
    return [*checks, *(failed_check(failed, "compared") for failed in failures)]


def _of_robot(record: Mapping[str, Any]) -> Iterator[RobotCheck]:
    robot = record["robot"]
    for name, quantity in record["quantities"].items():
        found = () if quantity["agrees"] else (_finding(record, name, quantity),)
        yield RobotCheck(robot, name, found)
    for name, reason in record["not_compared"].items():
        yield RobotCheck(robot, name, skipped=f"not compared: {reason}")


def _finding(record: Mapping[str, Any], name: str, quantity: Mapping[str, Any]) -> CommandFinding:
    error, worst = quantity["max_relative_error"], quantity["worst"]
    said = "infinite" if error is None else f"{error:.1e}"
    where = f", worst at {worst['case']} (route {worst['route']})" if worst else ""
    message = f"graphdyn and Pinocchio disagree: relative error {said}, bound {quantity['bound']:.1e}{where}"
    file = record["file"] or record["robot"]
    return CommandFinding(
        "disagreement", "error", record["robot"], name, file, 1, message, DISAGREEMENT_REMEDY, fails=True
    )
