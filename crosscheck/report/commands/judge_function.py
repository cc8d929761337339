"""One judged function: its errors against every reference implementation, over the states, and its worst call."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from crosscheck.judging.judgement import JudgedFunction, Judgement
from crosscheck.report.commands.errors import ERROR, distribution, over_states, verdict_of
from crosscheck.report.pictures.spread import SpreadRow
from crosscheck.report.report import Code, Column, Row, Section, Table
from crosscheck.report.snippets import worst_call
from graphdyn import RobotModel
from graphdyn.layout import Array

MOST_ENTRIES = 12
"""Of a matrix, the entries shown at most, those that differ most; the code to reproduce them has all."""


def counted(errors: Array) -> Array:
    """Errors that are no numbers count as infinite."""
    return np.where(np.isnan(errors), np.inf, errors)


def function_section(judgement: Judgement, function: JudgedFunction) -> Section:
    """For the page: the errors in detail, and the worst call."""
    contests = [
        *(SpreadRow(f"against {who}", counted(errors), function.bound) for who, errors in function.errors.items()),
        *(
            SpreadRow(f"{who} against graphdyn", counted(errors), function.bound)
            for who, errors in function.referees_differ.items()
        ),
    ]
    backward = [
        *(
            SpreadRow(f"torques of {who}", counted(errors), function.bound)
            for who, errors in function.backward_errors.items()
        ),
        *(
            SpreadRow(f"{who} by torques of graphdyn", counted(errors), function.bound)
            for who, errors in function.referees_differ_backward.items()
        ),
    ]
    return Section(
        function.name,
        function.name,
        (
            _contests(contests, f"Errors over all states, relative to {function.scale}"),
            *(
                [_contests(backward, f"Backward errors over all states, relative to {function.backward_scale}")]
                if backward
                else []
            ),
            distribution([*contests, *backward]),
            *over_states(
                {contest.name: contest.errors for contest in [*contests, *backward]},
                function.bound,
                "relative error",
                "state, the random ones first",
                "Against every reference implementation.",
            ),
            _worst_call(judgement.model, function),
            Code(
                worst_call(judgement, function),
                title="Python that computes the expected answer beside the one that was given",
                on=("page",),
            ),
        ),
        verdict_of(function.agrees, function.referees_agree),
        sheet=True,
    )


def _contests(contests: Sequence[SpreadRow], caption: str) -> Table:
    return Table(
        (
            Column("comparison", "name"),
            Column("verdict", "verdict"),
            *(Column(title, **ERROR) for title in ("median", "largest", "bound")),
        ),
        tuple(
            Row((contest.name, verdict, _median(contest.errors), contest.largest, contest.bound), verdict.state)
            for contest in contests
            for verdict in [verdict_of(contest.agrees, decided=True)]
        ),
        caption=caption,
        on=("page",),
    )


def _median(errors: Array) -> float:
    """The lower one of an even number: an error that occurred."""
    return float(np.sort(errors)[(len(errors) - 1) // 2])


def _worst_call(model: RobotModel, function: JudgedFunction) -> Table:
    """All entries of a vector in their order, or the MOST_ENTRIES of a matrix that differ most, worst first."""
    names, expected, answer = model.joint_names, function.worst.expected, function.worst.answer
    width, chosen = len(expected) // len(names), list(range(len(expected)))
    if width > 1:
        difference = [math.inf if math.isnan(y) else abs(x - y) for x, y in zip(expected, answer, strict=True)]
        chosen = sorted(chosen, key=lambda k: difference[k], reverse=True)[:MOST_ENTRIES]
    differ = "Both answers where they differ most"
    return Table(
        (
            Column("joint", "name"),
            *([Column("column", "number")] if width > 1 else []),
            *(Column(title, "number") for title in ("expected", "answer", "difference")),
        ),
        tuple(
            Row(
                (
                    names[k // width],
                    *([k % width + 1] if width > 1 else []),
                    f"{expected[k]:.9g}",
                    f"{answer[k]:.9g}",
                    f"{answer[k] - expected[k]:.2g}",
                )
            )
            for k in chosen
        ),
        title="The worst call",
        caption=differ if width == 1 else f"Largest differences of {len(expected)} entries",
        on=("page",),
    )
