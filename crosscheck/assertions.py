"""compare and judge for test suites: they raise an AssertionError whose message is the table of errors."""

from __future__ import annotations

from typing import Any

from crosscheck.commands.crosscheck.report import crosscheck_report
from crosscheck.commands.judge.report import judge_report
from crosscheck.comparing.compare import compare
from crosscheck.comparing.comparison import Comparison
from crosscheck.judging.judge import judge
from crosscheck.judging.judgment import Judgment
from crosscheck.reference.subject import Robot
from crosscheck.report.text import as_text


class Disagreement(AssertionError):
    """Raised by assert_agrees; prints the table. comparison: all numbers."""

    def __init__(self, comparison: Comparison):
        self.comparison = comparison
        super().__init__(
            f"graphdyn and Pinocchio disagree on '{comparison.robot}'\n{as_text(crosscheck_report([comparison]))}"
        )


class WrongDynamics(AssertionError):
    """Raised by assert_correct; prints verdict and diagnoses. judgment: all numbers."""

    def __init__(self, judgment: Judgment):
        self.judgment = judgment
        super().__init__(as_text(judge_report(judgment)))


def assert_agrees(robot: Robot, samples: int = 1000, seed: int = 0, **options: Any) -> Comparison:
    """compare, for test suites: returns the Comparison, or raises Disagreement (an AssertionError) with the table."""
    comparison = compare(robot, samples, seed, **options)
    if not comparison.agrees:
        raise Disagreement(comparison)
    return comparison


def assert_correct(robot: Robot, **options: Any) -> Judgment:
    """judge, for test suites: returns the Judgment, or raises WrongDynamics (an AssertionError) with the diagnoses."""
    judgment = judge(robot, **options)
    if not (judgment.agrees and judgment.decided):
        raise WrongDynamics(judgment)
    return judgment
