"""The page of a judgement: what is wrong with foreign functions, and the numbers that show it."""

from __future__ import annotations

import math
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from markupsafe import Markup

from crosscheck.judging.judgement import JudgedFunction, Judgement
from crosscheck.report import snippets
from crosscheck.report.pages.rendering import render
from crosscheck.report.pictures.spread import SpreadRow, spread
from crosscheck.report.pictures.stick_figure import pose_text, stick_figure
from crosscheck.report.versions import versions
from graphdyn import RobotModel
from graphdyn.layout import Array

MOST_ENTRIES = 12
"""Of a matrix, so many entries are shown, those that differ most; the snippet has all."""


@dataclass(frozen=True, eq=False)
class Contest:
    """Errors of one side against another: who, the errors (N,), their median and largest, whether all are in bound."""

    who: str
    errors: Array
    median: float
    largest: float
    agrees: bool


@dataclass(frozen=True)
class Entry:
    """One entry of both answers at the worst call; column is None for a vector."""

    joint: str
    column: int | None
    expected: float
    answer: float


@dataclass(frozen=True, eq=False)
class Section:
    """What the template needs of one function beyond its judgement.

    verdict: agrees, disagrees or undecided; largest: error over all states and referees
    vector: the answer is one number per joint, and all are among the entries
    """

    function: JudgedFunction
    verdict: str
    largest: float
    contests: tuple[Contest, ...]
    entries: tuple[Entry, ...]
    vector: bool
    snippet: str
    spread: Markup


def judgement_page(judgement: Judgement, command: Sequence[str]) -> str:
    """One page about all judged functions. The same arguments and versions give the same characters.

    command: the arguments that made the judgement
    """
    name, model = Path(judgement.robot).name, judgement.model
    return render(
        "judgement.html",
        judgement=judgement,
        name=name,
        model=model,
        overall=_verdict(judgement.agrees, judgement.decided),
        sections=[
            _section(judgement, function, model, f"function-{k}")
            for k, function in enumerate(judgement.functions.values(), start=1)
        ],
        figure=stick_figure("robot", model, name),
        pose=pose_text(model),
        command=shlex.join(command),
        versions=versions(),
    )


def _section(judgement: Judgement, function: JudgedFunction, model: RobotModel, key: str) -> Section:
    contests = [
        *(_contest(f"against {who}", errors, function.bound) for who, errors in function.errors.items()),
        *(
            _contest(f"referee {who} against graphdyn", errors, function.bound)
            for who, errors in function.referees_differ.items()
        ),
    ]
    return Section(
        function,
        _verdict(function.agrees, function.referees_agree),
        max(contest.largest for contest in contests[: len(function.errors)]),
        tuple(contests),
        _entries(model, function),
        len(function.worst.expected) == len(judgement.joint_names),
        snippets.worst_call(judgement, function),
        spread(key, [SpreadRow(contest.who, contest.errors, function.bound) for contest in contests]),
    )


def _contest(who: str, errors: Array, bound: float) -> Contest:
    counted = np.where(np.isnan(errors), np.inf, errors)
    median = float(np.sort(counted)[(len(counted) - 1) // 2])
    return Contest(who, counted, median, float(counted.max()), bool((counted <= bound).all()))


def _entries(model: RobotModel, function: JudgedFunction) -> tuple[Entry, ...]:
    """All entries of a vector in their order, or the MOST_ENTRIES of a matrix that differ most, worst first."""
    names, expected, answer = model.joint_names, function.worst.expected, function.worst.answer
    width = len(expected) // len(names)
    if width == 1:
        return tuple(Entry(name, None, x, y) for name, x, y in zip(names, expected, answer, strict=True))
    difference = [math.inf if math.isnan(y) else abs(x - y) for x, y in zip(expected, answer, strict=True)]
    chosen = sorted(range(len(expected)), key=lambda k: difference[k], reverse=True)[:MOST_ENTRIES]
    return tuple(Entry(names[k // width], k % width + 1, expected[k], answer[k]) for k in chosen)


def _verdict(agrees: bool, referees_agree: bool) -> str:
    if not referees_agree:
        return "undecided"
    return "agrees" if agrees else "disagrees"
