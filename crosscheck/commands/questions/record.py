"""The format `graphdyn questions 2`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from crosscheck.judging.exchange.questions import Question
from crosscheck.quantities import FUNCTIONS
from crosscheck.report.records.record import Keywords, Record, Versions, Warnings, written

Numbers = Sequence[float] | Sequence[Sequence[float]]


class QuestionRecord(Record, of=Question):
    """One call of a function.

    shape: of the answer, a matrix row by row; null for any number
    """

    shape: Sequence[int | None]
    arguments: Mapping[str, Annotated[Numbers, Keywords(description="(n,); external_wrenches (n, 6).")]]


class QuestionsRecord(Record, format="graphdyn questions 2"):
    """Questions to user code, of which `graphdyn judge --answers` takes the answers.

    robot: as given
    joint_names: the order of the joints
    frame: that functions of one frame belong to; null where none was named
    questions: one per call
    """

    versions: Versions
    warnings: Warnings
    robot: str
    joint_names: Sequence[str]
    frame: str | None
    questions: Sequence[QuestionRecord]


def record(robot: str, joint_names: Sequence[str], frame: str | None, questions: Sequence[Question]) -> dict[str, Any]:
    """robot: as given"""
    n = len(joint_names)
    return written(
        QuestionsRecord,
        robot=robot,
        joint_names=joint_names,
        frame=frame,
        questions=[written(QuestionRecord, one, shape=FUNCTIONS[one.function].shape_for(n)) for one in questions],
    )
