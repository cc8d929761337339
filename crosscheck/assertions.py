"""compare and judge for test suites: they raise an AssertionError whose message is the table of errors."""

from __future__ import annotations

from collections.abc import Callable
from inspect import signature
from typing import Any, ParamSpec, TypeVar

from crosscheck.commands.crosscheck.disagreement import disagreement_report
from crosscheck.commands.judge.report import judge_report
from crosscheck.comparing.compare import compare
from crosscheck.comparing.comparison import Comparison
from crosscheck.judging.judge import judge
from crosscheck.judging.judgment import Judgment
from crosscheck.report.text import as_text

P = ParamSpec("P")
Answer = TypeVar("Answer")


def with_arguments_of(other: Callable[P, object]) -> Callable[[Callable[..., Answer]], Callable[P, Answer]]:
    """A decorator: the function takes what another takes, for type checkers, editors and inspect.signature."""

    def declared(function: Callable[..., Answer]) -> Callable[P, Answer]:
        function.__signature__ = signature(other).replace(  # type: ignore[attr-defined]
            return_annotation=signature(function).return_annotation
        )
        return function

    return declared


class Disagreement(AssertionError):
    """Raised by assert_agrees; prints what disagrees, and both sides where it is worst. comparison: all numbers."""

    def __init__(self, comparison: Comparison):
        self.comparison = comparison
        super().__init__(
            f"graphdyn and Pinocchio disagree on '{comparison.robot}'\n{as_text(disagreement_report(comparison))}"
        )


class WrongDynamics(AssertionError):
    """Raised by assert_correct; prints verdict and diagnoses. judgment: all numbers."""

    def __init__(self, judgment: Judgment):
        self.judgment = judgment
        super().__init__(as_text(judge_report(judgment)))


@with_arguments_of(compare)
def assert_agrees(*arguments: Any, **options: Any) -> Comparison:
    """compare, for test suites: returns the Comparison, or raises Disagreement (an AssertionError).

    Its message has the quantities that disagree, and both sides of the worst.
    """
    comparison = compare(*arguments, **options)
    if not comparison.agrees:
        raise Disagreement(comparison)
    return comparison


@with_arguments_of(judge)
def assert_correct(*arguments: Any, **options: Any) -> Judgment:
    """judge, for test suites: returns the Judgment, or raises WrongDynamics (an AssertionError) with the diagnoses."""
    judgment = judge(*arguments, **options)
    if not (judgment.agrees and judgment.decided):
        raise WrongDynamics(judgment)
    return judgment
