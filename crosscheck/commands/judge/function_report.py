"""One judged function: its errors against every reference implementation, over the states, and its worst call."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from crosscheck.commands.judge.exact_report import exact_table
from crosscheck.judging.judgment import JudgedFunction, Judgment, infinite_where_nan
from crosscheck.quantities import FUNCTIONS, LOADS
from crosscheck.report.error_tables import ERROR_FORMAT, distribution, over_states, verdict_of
from crosscheck.report.pictures.spread import SpreadRow
from crosscheck.report.report import Code, Column, Facts, Row, Section, Table
from crosscheck.report.snippets import smallest_test, worst_call
from graphdyn import RobotModel
from graphdyn.errors import first_of
from graphdyn.layout import Array

FIRST_ENTRY_SHARE = 1e-3
"""Part of the largest deviation from which on an entry is the first that deviates."""

NOTHING_SHARE = 1e-12
"""Part of the largest entry below which one is shown as 0."""

MAX_SHOWN_ENTRIES = 12
"""Largest number of entries of a matrix that are shown, those that differ most; the code to reproduce them has all."""


def function_section(judgment: Judgment, function: JudgedFunction) -> Section:
    """The section of the page with the errors in detail, and the worst call."""
    contests = [
        *_rows("against {}", function.errors, function.bound),
        *_rows("{} against graphdyn", function.references_differ, function.bound),
    ]
    backward = [
        *_rows("torques of {}", function.backward_errors, function.bound),
        *_rows("{} by torques of graphdyn", function.references_differ_backward, function.bound),
    ]
    test = smallest_test(judgment, function)
    tables = [_contests(contests, f"Errors over all states, relative to {function.scale}")]
    if backward:
        tables.append(_contests(backward, f"Backward errors over all states, relative to {function.backward_scale}"))
    return Section(
        function.name,
        function.name,
        (
            *tables,
            *exact_table(function),
            distribution([*contests, *backward]),
            *over_states(
                {contest.name: contest.errors for contest in [*contests, *backward]},
                function.bound,
                "relative error",
                "state, the random ones first",
                "Against every reference implementation.",
            ),
            *([_failed_states(function)] if function.failures else []),
            _worst_call(judgment.model, function),
            Code(
                worst_call(judgment, function),
                title="Python that computes the expected answer beside the one that was given",
                on=("page",),
            ),
            *([Code(test, title="A test of the smallest example", on=("page",))] if test else []),
        ),
        verdict_of(function.agrees, function.decided),
        sheet=True,
    )


def smallest_example(judgment: Judgment, function: JudgedFunction) -> Facts | None:
    """The smallest call at which a function deviates, and the first entry that does; None where there is none."""
    call = function.smallest
    if call is None:
        return None
    called = "; ".join(_argument(judgment.joint_names, name, values) for name, values in call.arguments.items())
    expected, answer = np.array(call.expected), np.array(call.answer)
    if expected.shape != answer.shape:
        return Facts((("called with", called),), title=f"{function.name}: the smallest example")
    off = np.where(np.isfinite(answer), np.abs(answer - expected), np.inf)
    largest = off.max(initial=0.0)
    differing = np.flatnonzero(off > FIRST_ENTRY_SHARE * largest if np.isfinite(largest) else np.isinf(off))
    first, shape = int(differing[0]), FUNCTIONS[function.name].shape
    sizes = [size or -1 for size in FUNCTIONS[function.name].shape_for(judgment.model.n_bodies)]
    place = list(np.ndindex(expected.reshape(sizes).shape))[first]
    said = [
        f"joint '{judgment.model.joint_names[number]}'" if size == "n" else f"entry {number + 1}"
        for size, number in zip(shape, place, strict=True)
    ]
    size = np.abs(expected).max(initial=0.0)
    given, right = (0.0 if abs(x[first]) <= NOTHING_SHARE * size else x[first] for x in (answer, expected))
    where = f"{', '.join(said) or 'the answer'}: {given:.6g}, not {right:.6g}"
    count = f"{where}; {len(differing)} of {len(off)} entries deviate" if len(off) > 1 else where
    items = (("called with", called), ("first deviation", count))
    return Facts(items, title=f"{function.name}: the smallest example")


def _argument(joint_names: Sequence[str], name: str, values: Sequence[float]) -> str:
    """Such as "v = 0 but for 'elbow' 1"."""
    if not any(values):
        return f"{name} = 0"
    if name == LOADS:
        shown = [f"'{joint_names[k // 6]}' entry {k % 6 + 1}: {x:.6g}" for k, x in enumerate(values) if x]
    else:
        shown = [f"'{joint_names[k]}' {x:.6g}" for k, x in enumerate(values) if x]
    return f"{name} = 0 but for {first_of(shown, MAX_SHOWN_ENTRIES)}"


def _rows(name: str, errors: Mapping[str, Array], bound: float) -> list[SpreadRow]:
    """A row for each reference. name: with {} in place of the reference"""
    return [SpreadRow(name.format(who), infinite_where_nan(error), bound) for who, error in errors.items()]


def _contests(contests: Sequence[SpreadRow], caption: str) -> Table:
    return Table(
        (
            Column("comparison", "name"),
            Column("verdict", "verdict"),
            *(Column(title, **ERROR_FORMAT) for title in ("median", "largest", "bound")),
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
    """All entries of a vector in their order, or the MAX_SHOWN_ENTRIES of an array that differ most, worst first."""
    shape = FUNCTIONS[function.name].shape
    expected, answer = function.worst.expected, function.worst.answer
    sizes = [size or -1 for size in FUNCTIONS[function.name].shape_for(model.n_bodies)]
    places = list(np.ndindex(np.reshape(expected, sizes).shape))
    chosen = list(range(min(len(expected), len(answer))))
    if len(shape) > 1:
        difference = [math.inf if math.isnan(y) else abs(x - y) for x, y in zip(expected, answer, strict=False)]
        chosen = sorted(chosen, key=lambda k: difference[k], reverse=True)[:MAX_SHOWN_ENTRIES]
    differ = "Both answers where they differ most"
    of_joints = shape[:1] == ("n",)
    axes = [Column("joint" if of_joints else "row", "name"), *[Column("column", "number")] * (len(shape) - 1)]
    return Table(
        (*axes[: len(shape)], *(Column(title, "number") for title in ("expected", "answer", "difference"))),
        tuple(
            Row(
                (
                    *(_place(model, of_joints, axis, number) for axis, number in enumerate(places[k])),
                    f"{expected[k]:.9g}",
                    f"{answer[k]:.9g}",
                    f"{answer[k] - expected[k]:.2g}",
                )
            )
            for k in chosen
        ),
        title="The worst call",
        caption=differ if len(shape) <= 1 else f"Largest differences of {len(expected)} entries",
        on=("page",),
    )


def _place(model: RobotModel, of_joints: bool, axis: int, number: int) -> str | int:
    return model.joint_names[number] if of_joints and axis == 0 else number + 1


def _failed_states(function: JudgedFunction) -> Table:
    return Table(
        (Column("state", "number"), Column("what it did")),
        tuple(Row((failure.number + 1, failure.message)) for failure in function.failures),
        title="States without an answer",
        on=("page",),
    )
