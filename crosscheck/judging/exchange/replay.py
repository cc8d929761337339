"""Answers from files as a function under test, and the questions that are still to be answered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from crosscheck.judging.exchange.answer_files import BadAnswers, GivenAnswer
from crosscheck.judging.exchange.protocols import Shape, UnreadableAnswer, shaped
from crosscheck.judging.exchange.questions import Question, once, question
from crosscheck.judging.observing.function_under_test import FunctionFailure
from crosscheck.quantities.tested_function import Refusal
from graphdyn import GraphDynError
from graphdyn.layout import Array

QUESTION_STAGES = 3
"""Stages in which a function is asked: the judged states, its noise, and the experiments on a function that deviates.
The last two are one round of questions."""

MAX_LISTED_IDS = 5
"""Ids that a message lists at most."""


class AnswersPending(GraphDynError):
    """The diagnosis needs answers of this shape to further questions."""

    def __init__(self, questions: Sequence[Question], shape: Shape = ()):
        super().__init__(f"{len(questions)} further questions need answers: {listed([one.id for one in questions])}")
        self.questions, self.shape = questions, shape


class Replay:
    """A function under test whose answers are in files.

    given: the answers by id, those of other functions among them
    used: the ids that were asked for, added to at each call
    """

    def __init__(self, given: Mapping[int, GivenAnswer], used: set[int]):
        self._given, self._used = given, used
        self._stages = 0

    def answers(self, function: str, states: Sequence[Mapping[str, Array]], shape: Shape) -> list[Array | Refusal]:
        """The answer (shape) at each state; none where a number is not finite.

        Raises BadAnswers where some answers of a stage are missing, or of another size; AnswersPending where further
        answers are needed; FunctionFailure where a stage beyond QUESTION_STAGES would need them.
        """
        asked = [question(function, state) for state in states]
        new = once(one for one in asked if one.id not in self._used)
        missing = [one for one in new if one.id not in self._given]
        if new:
            self._begin_stage(function, missing, shape, partly=len(missing) < len(new))
        self._used |= {one.id for one in new}
        return [self._answer(one, shape) for one in asked]

    def _begin_stage(self, function: str, missing: Sequence[Question], shape: Shape, *, partly: bool) -> None:
        """missing: questions without an answer; partly: others have one"""
        if missing and self._stages == QUESTION_STAGES:
            raise FunctionFailure(f"{function} would have to answer questions in a further round")
        if missing and (partly or self._stages == 0):
            ids = listed([one.id for one in missing])
            raise BadAnswers(f"{function}: no answers to {len(missing)} questions, ids {ids}")
        if missing:
            raise AnswersPending(missing, shape)
        self._stages += 1

    def _answer(self, one: Question, shape: Shape) -> Array | Refusal:
        given = self._given[one.id]
        wrong = np.flatnonzero(~np.isfinite(given.numbers))
        try:
            found = shaped(given.numbers, shape, f"{given.where}, id {one.id}, {one.function}")
        except UnreadableAnswer as error:
            raise BadAnswers(str(error)) from None
        if len(wrong):
            return Refusal(f"{given.where}, id {one.id}: number {wrong[0] + 1} is {given.numbers[wrong[0]]}")
        return found


def listed(ids: Sequence[int]) -> str:
    """The first ones."""
    rest = len(ids) - MAX_LISTED_IDS
    return ", ".join(map(str, ids[:MAX_LISTED_IDS])) + (f" and {rest} more" if rest > 0 else "")
