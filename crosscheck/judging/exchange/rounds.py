"""Judging by files: the questions of each round, answers from files as a function under test, and their judgment."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.judging.exchange.answer_files import BadAnswers, GivenAnswer
from crosscheck.judging.exchange.printed_numbers import UnreadableAnswer
from crosscheck.judging.exchange.protocols import Shape, shaped
from crosscheck.judging.exchange.questions import Question, once, question, questions
from crosscheck.judging.judge import Progress, drawn_states, judge_functions, robot_of
from crosscheck.judging.judgment import Judgment
from crosscheck.judging.observing.function_under_test import FunctionFailure, FunctionUnderTest, joint_order
from crosscheck.judging.setting import Setting
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS, LOADS, Quantity, known_function
from crosscheck.quantities.tested_function import Refusal, TestedFunction
from graphdyn import GraphDynError
from graphdyn.errors import counted, first_of
from graphdyn.layout import Array

QUESTION_STAGES = 3
"""Stages in which a function is asked: the judged states, its noise, and the experiments on a function that deviates.
The last two are one round of questions."""

MAX_LISTED_IDS = 5
"""Ids that a message lists at most."""


class AnswersPending(GraphDynError):
    """The diagnosis needs answers of this shape to further questions."""

    def __init__(self, questions: Sequence[Question], shape: Shape = ()):
        super().__init__(f"further questions need answers: {listed([one.id for one in questions])}")
        self.questions, self.shape = questions, shape


class Replay:
    """A function under test whose answers are in files.

    given: the answers by id, those of other functions among them
    used: the ids that were asked for, added to at each call
    in_rounds: it cannot be asked about single joints besides the experiments
    """

    in_rounds = True

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
            raise BadAnswers(f"{function}: no answers to {counted(len(missing), 'question')}, {ids}")
        if missing:
            raise AnswersPending(missing, shape)
        self._stages += 1

    def _answer(self, one: Question, shape: Shape) -> Array | Refusal:
        given = self._given[one.id]
        wrong = np.flatnonzero(~np.isfinite(given.numbers.astype(float)))
        try:
            found = shaped(given.numbers, shape, f"{given.where}, id {one.id}, {one.function}")
        except UnreadableAnswer as error:
            raise BadAnswers(str(error)) from None
        if len(wrong):
            return Refusal(f"{given.where}, id {one.id}: number {wrong[0] + 1} is {given.numbers[wrong[0]]}")
        return found


def listed(ids: Sequence[int]) -> str:
    """The first ones: "id 12", "ids 12, 13"."""
    return f"{'id' if len(ids) == 1 else 'ids'} {first_of(ids, MAX_LISTED_IDS)}"


@dataclass(frozen=True, eq=False)
class FirstRound:
    """Questions about one robot. joint_names: their joint order"""

    joint_names: tuple[str, ...]
    questions: tuple[Question, ...]


def states_for(setting: Setting, functions: Collection[Quantity]) -> JudgedStates:
    """The judged states. Raises as robot_of."""
    robot = robot_of(setting, [known.name for known in functions])
    return drawn_states(robot.model.uncoupled, setting, functions)


def states_of(known: Quantity, states: JudgedStates, setting: Setting) -> JudgedStates:
    """The states of one function: without external wrenches, where it is not called with them."""
    return states if LOADS in known.called_with(setting.external_wrenches) else replace(states, loads=None)


def first_round(setting: Setting, names: Collection[str]) -> FirstRound:
    """The questions at the judged states. names: of FUNCTIONS

    Raises SameId, and what robot_of raises.
    """
    functions = [known_function(name) for name in names]
    states = states_for(setting, functions)
    order = joint_order(states.model, setting.joint_names)
    asked: list[Question] = []
    for known in functions:
        function = FunctionUnderTest(known, Replay({}, set()), order, loaded=setting.external_wrenches)
        asked += questions(function, known.arguments_at(states_of(known, states, setting)))
    return FirstRound(tuple(states.model.joint_names[k] for k in order), tuple(once(asked)))


def answered_functions(setting: Setting, given: Mapping[int, GivenAnswer]) -> list[str]:
    """Names of the functions to whose questions there are answers. Raises BadAnswers where there is none."""
    candidates = [name for name, known in FUNCTIONS.items() if setting.frame is not None or not known.of_frame]
    known = first_round(setting, candidates).questions
    found = {one.function for one in known if one.id in given}
    if not found:
        raise BadAnswers(
            f"{next(iter(given.values())).where}: no question has {listed(list(given))}"
            "; give the same robot and options (--samples, --seed, --joint-names, --lock and so on) as to "
            "`graphdyn questions`, and leave the ids as they are"
        )
    return [name for name in candidates if name in found]


def judge_answers(
    setting: Setting,
    given: Mapping[int, GivenAnswer],
    others: Mapping[str, TestedFunction],
    progress: Progress | None = None,
) -> tuple[Judgment, list[int]]:
    """The judgment of answers and of other functions, and the ids that belong to no question.

    given: answers by id, may be none; others: functions besides, by name

    Raises AnswersPending with the questions of the second round of all functions, BadAnswers, and what crosscheck.judge
    raises.
    """
    names = answered_functions(setting, given) if given else []
    if both := [name for name in names if name in others]:
        raise BadAnswers(f"there are answers of {both[0]}, which an option names as well; leave one of them out")
    used: set[int] = set()

    def pending(name: str) -> Sequence[Question]:
        """The pending questions of all stages: what is asked later does not depend on the numbers of earlier
        answers."""
        supposed, asked = dict(given), list[Question]()
        for _ in range(QUESTION_STAGES - 1):
            try:
                judge_functions({name: Replay(supposed, set())}, setting, progress)
            except AnswersPending as found:
                asked += found.questions
                nothing = np.zeros(math.prod(size or 1 for size in found.shape))
                supposed |= {one.id: GivenAnswer(nothing, "supposed") for one in found.questions}
        return asked

    try:
        answered = {name: Replay(given, used) for name in names}
        judgment = judge_functions({**answered, **others}, setting, progress)
    except AnswersPending:
        raise AnswersPending([one for name in names for one in pending(name)]) from None
    return judgment, [number for number in given if number not in used]
