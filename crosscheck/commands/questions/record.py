"""The format `graphdyn questions 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.judging.exchange.questions import Question
from crosscheck.quantities import FUNCTIONS
from crosscheck.report.record_fields import FORMAT, Keywords, Versions
from crosscheck.report.versions import versions

Numbers = Sequence[float] | Sequence[Sequence[float]]


@dataclass(frozen=True, kw_only=True)
class QuestionRecord:
    """One call of a function."""

    id: int
    """To be repeated with the answer: [{"id": …, "answer": […]}, …]."""

    function: str
    """Its name."""

    shape: Sequence[int | None]
    """Of the answer, a matrix row by row; null for any number."""

    arguments: Mapping[str, Annotated[Numbers, Keywords(description="(n,); external_wrenches (n, 6).")]]
    """By name, in the order in which the function takes them [rad or m, …/s, …/s², N m or N]."""


@dataclass(frozen=True, kw_only=True)
class QuestionsRecord:
    """Questions to foreign code, of which `graphdyn judge --answers` takes the answers."""

    format: Annotated[Literal["graphdyn questions 1"], FORMAT] = "graphdyn questions 1"

    versions: Versions = field(default_factory=versions)

    robot: str
    """As given."""

    joint_names: Sequence[str]
    """The order of the joints."""

    frame: str | None
    """That functions of one frame belong to. Null where none was named."""

    questions: Sequence[QuestionRecord]
    """One per call."""


def record(robot: str, joint_names: Sequence[str], frame: str | None, questions: Sequence[Question]) -> QuestionsRecord:
    """robot: as given"""
    return QuestionsRecord(
        robot=robot,
        joint_names=joint_names,
        frame=frame,
        questions=[
            QuestionRecord(
                id=one.id,
                function=one.function,
                shape=FUNCTIONS[one.function].shape_for(len(joint_names)),
                arguments={name: x.tolist() for name, x in one.arguments.items()},
            )
            for one in questions
        ],
    )
