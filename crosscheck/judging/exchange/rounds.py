"""Judging by files: the questions of the first round, and a judgment of answers or the questions of the second."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from crosscheck.judging.exchange.answer_files import BadAnswers, GivenAnswer
from crosscheck.judging.exchange.questions import Question, once, questions
from crosscheck.judging.exchange.replay import QUESTION_STAGES, AnswersPending, Replay, listed
from crosscheck.judging.judge import Progress, check_frame, judge_functions
from crosscheck.judging.judgment import Judgment
from crosscheck.judging.observing.function_under_test import FunctionUnderTest, joint_order
from crosscheck.judging.setting import Setting
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities import FUNCTIONS, LOADS, Quantity, known_function
from crosscheck.quantities.tested_function import TestedFunction
from crosscheck.reference.subject import check_counts, refuse_chords, subject
from graphdyn import RobotModel


@dataclass(frozen=True, eq=False)
class FirstRound:
    """Questions about one robot. joint_names: their joint order"""

    model: RobotModel
    joint_names: tuple[str, ...]
    questions: tuple[Question, ...]


def drawn_states(setting: Setting, functions: Collection[Quantity]) -> JudgedStates:
    """The judged states. Raises InvalidInput, UnknownFrame, and urdf's errors for a file that cannot be loaded."""
    check_counts(setting.samples, setting.seed)
    given = subject(setting.robot, setting.reading)
    refuse_chords(given.model)
    model = given.model.uncoupled
    check_frame([known.name for known in functions], setting.frame, model)
    return JudgedStates.draw(
        model,
        setting.samples,
        setting.seed,
        needs_tau=any("tau" in known.arguments for known in functions),
        loaded=setting.external_wrenches or any(LOADS in known.arguments for known in functions),
        beyond_limits=setting.beyond_limits,
        frame=setting.frame,
    )


def states_of(known: Quantity, states: JudgedStates, setting: Setting) -> JudgedStates:
    """The states of one function: without external wrenches, where it is not called with them."""
    return states if LOADS in known.called_with(setting.external_wrenches) else replace(states, loads=None)


def first_round(setting: Setting, names: Collection[str]) -> FirstRound:
    """The questions at the judged states. names: of FUNCTIONS

    Raises SameId, and what drawn_states raises.
    """
    functions = [known_function(name) for name in names]
    states = drawn_states(setting, functions)
    order = joint_order(states.model, setting.joint_names)
    asked: list[Question] = []
    for known in functions:
        function = FunctionUnderTest(known, Replay({}, set()), order, loaded=setting.external_wrenches)
        asked += questions(function, known.arguments_at(states_of(known, states, setting)))
    return FirstRound(states.model, tuple(states.model.joint_names[k] for k in order), tuple(once(asked)))


def answered_functions(setting: Setting, given: Mapping[int, GivenAnswer]) -> list[str]:
    """Names of the functions to whose questions there are answers. Raises BadAnswers where there is none."""
    candidates = [name for name, known in FUNCTIONS.items() if setting.frame is not None or not known.of_frame]
    known = first_round(setting, candidates).questions
    found = {one.function for one in known if one.id in given}
    if not found:
        raise BadAnswers(
            f"{next(iter(given.values())).where}: none of the {len(given)} ids ({listed(list(given))}) is that of a "
            "question; give the same robot and options (--samples, --seed, --joint-names, --lock and so on) as to "
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
