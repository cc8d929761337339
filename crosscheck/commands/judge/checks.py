"""The checks of `graphdyn judge`: a check per function, for the files of pipelines. A fault is told where it is."""

from __future__ import annotations

from collections.abc import Mapping

from crosscheck.judging.judgment import Diagnosis, JudgedFunction, Judgment
from crosscheck.report.findings.checks import CommandFinding, RobotCheck


def judge_checks(judgment: Judgment, places: Mapping[str, tuple[str, int]]) -> list[RobotCheck]:
    """places: file and line of functions, by name; faults of others are told at the robot's file"""
    robot = judgment.file or judgment.robot
    return [
        RobotCheck(judgment.robot, name, _findings(judgment, function, places.get(name, (robot, 1))))
        for name, function in judgment.functions.items()
    ]


def _findings(judgment: Judgment, function: JudgedFunction, place: tuple[str, int]) -> tuple[CommandFinding, ...]:
    def finding(code: str, message: str, remedy: str) -> CommandFinding:
        return CommandFinding(code, "error", judgment.robot, function.name, *place, message, remedy, fails=True)

    if function.agrees and function.decided:
        return ()
    if not function.decided:
        references = ", ".join(judgment.references)
        problem = f"the reference implementations ({references}) disagree: no verdict"
        return (finding("undecided", problem, "judge with --exact"),)
    said = [each for each in judgment.diagnoses if function.name in each.function.split(", ")]
    if said:
        return tuple(finding(each.kind.replace("_", "-"), _sentence(each), each.remedy) for each in said)
    largest = max(float(error.max()) for error in function.errors.values())
    problem = f"it disagrees with {', '.join(judgment.references)}: relative error {largest:.1e}"
    return (finding("disagreement", f"{problem}, bound {function.bound:.1e}", "see the report"),)


def _sentence(diagnosis: Diagnosis) -> str:
    return f"{diagnosis.message} ({diagnosis.status}: {diagnosis.evidence})"
