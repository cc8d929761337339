"""`graphdyn judge`: functions under test, and what is wrong with them, as a report."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path

from crosscheck.commands.judge.exact_report import exact_facts
from crosscheck.commands.judge.function_report import function_section, smallest_example
from crosscheck.commands.judge.record import record
from crosscheck.judging.judgment import Diagnosis, JudgedFunction, Judgment, infinite_where_nan
from crosscheck.report.error_tables import ERROR_FORMAT, verdict_of
from crosscheck.report.report import (
    WIDE_LINE_CHARACTERS,
    Block,
    Column,
    Facts,
    Group,
    Note,
    Notes,
    Report,
    Row,
    Section,
    Table,
    Verdict,
)
from crosscheck.report.robot_parts import joints_table, reading_text, robot_picture
from graphdyn.errors import counted, first_of
from graphdyn.layout import Array

MAX_LISTED_STATES = 20
"""Numbers of states without an answer that are listed at most; the page and the JSON file have all."""


def judge_report(judgment: Judgment) -> Report:
    """The verdict and the diagnoses, then the numbers of every function."""
    functions = list(judgment.functions.values())
    examples = [smallest_example(judgment, function) for function in functions]
    diagnoses = (
        *(block for diagnosis in judgment.diagnoses for block in _diagnosis(diagnosis)),
        *(example for example in examples if example is not None),
    )
    return Report(
        f"Your functions on {Path(judgment.robot).name}",
        replace(verdict_of(judgment.agrees, judgment.decided, _reason(judgment)), sentence=_sentence(judgment)),
        (
            *([Section("diagnoses", "What is wrong", diagnoses)] if diagnoses else []),
            Section(
                "errors",
                "Errors",
                (_errors(judgment), *exact_facts(functions), *_read(judgment), _to_be_known(judgment)),
            ),
            Section("judged", "What was judged", _judged(judgment)),
            *(function_section(judgment, function) for function in functions),
        ),
        record=partial(record, judgment),
    )


def _sentence(judgment: Judgment) -> str:
    if not judgment.decided:
        return "The reference implementations disagree."
    functions = judgment.functions.values()
    faulty = [function.name for function in functions if function.decided and not function.agrees]
    if faulty:
        return f"{', '.join(faulty)} {'is' if len(faulty) == 1 else 'are'} wrong."
    return f"Your function{'s agree' if len(functions) > 1 else ' agrees'} with the reference implementations."


def _reason(judgment: Judgment) -> str:
    functions, references = judgment.functions.values(), ", ".join(judgment.references)
    if judgment.agrees and judgment.decided:
        if proven := [function.name for function in functions if function.decided_by_proof]:
            return f"{', '.join(proven)}: no further from exact values than rounding explains."
        return (
            f"Every function gives the same numbers as every reference implementation ({references}), within its bound."
        )
    faulty = [function for function in functions if function.decided and not function.agrees]
    proven = [function.name for function in faulty if function.decided_by_proof and not function.right_where_answered]
    differing = [
        function.name for function in faulty if not function.right_where_answered and function.name not in proven
    ]
    wrong = f"{', '.join(differing)} {'disagrees' if len(differing) == 1 else 'disagree'} with"
    reasons = [f"{', '.join(proven)}: further from exact values than rounding explains."] if proven else []
    if judgment.decided:
        reasons += [f"{wrong} {references}, which agree with each other."] if differing else []
        if unanswered := ", ".join(function.name for function in faulty if function.failures):
            reasons.append(f"{unanswered}: no answer at single states.")
        if changing := ", ".join(function.name for function in faulty if not function.repeats):
            reasons.append(f"{changing}: other answers when asked again.")
        return " ".join(reasons)
    undecided = ", ".join(function.name for function in functions if not function.decided)
    others = f" {wrong} all of them, which agree with each other there." if differing else ""
    disagree = f"The reference implementations ({references}) disagree on {undecided}: no verdict there.{others}"
    return " ".join([disagree, *reasons])


STATUS_MEANINGS: Mapping[str, str] = {
    "confirmed": "graphdyn with this fault reproduces your function at every state",
    "candidate": "graphdyn with this fault reproduces your function at every state; so does another fault as simple",
    "part": "it explains a part of the deviation",
    "located": "the deviation is here; its cause is unknown",
    "unknown": "no explanation",
}
"""What each status of a diagnosis means."""


def _diagnosis(diagnosis: Diagnosis) -> tuple[Block, ...]:
    left = diagnosis.explains
    items = (
        ("status", f"{diagnosis.status}: {STATUS_MEANINGS[diagnosis.status]}"),
        ("evidence", diagnosis.evidence),
        ("remedy", diagnosis.remedy),
        *([("equivalent faults", "; or ".join(diagnosis.also))] if diagnosis.also else []),
        *([("distinguished by", diagnosis.apart)] if diagnosis.apart else []),
        ("unexplained", f"a relative error of {left:.1e}" if math.isfinite(left) else "the whole deviation"),
    )
    facts = Facts(items, title=f"{diagnosis.function}: {diagnosis.message} [{diagnosis.kind}]")
    return (facts, _fitted(diagnosis)) if diagnosis.numbers else (facts,)


def _fitted(diagnosis: Diagnosis) -> Table:
    """The numbers that were fitted, theirs and ours."""
    return Table(
        (
            Column("number", "name"),
            *(Column(title, "number", form=".6g") for title in ("theirs", "ours", "difference")),
            Column("unit"),
        ),
        tuple(
            Row((number.name, number.theirs, number.ours, number.difference, number.unit))
            for number in diagnosis.numbers
        ),
        caption="Fitted numbers: what the function must have, and what the robot has",
    )


def _errors(judgment: Judgment) -> Table:
    """A row per function, two for accelerations: the largest error against every reference implementation."""
    rows = []
    for function in judgment.functions.values():
        rows.append((function, function.name, function.errors, function.scale))
        if function.backward_errors:
            rows.append((function, "backward_error", function.backward_errors, function.backward_scale))
    return Table(
        (
            Column("function", "name"),
            Column("verdict", "verdict"),
            *(Column(reference, **ERROR_FORMAT) for reference in judgment.references),
            Column("bound", **ERROR_FORMAT),
            Column("relative to", from_width=WIDE_LINE_CHARACTERS),
        ),
        tuple(
            Row(
                (
                    name,
                    verdict,
                    *(_largest(errors, reference) for reference in judgment.references),
                    function.bound,
                    scale,
                ),
                verdict.state,
                link=function.name,
            )
            for function, name, errors, scale in rows
            for verdict in [_verdict(function, errors)]
        ),
        caption="Largest error over all states against each reference implementation",
    )


def _verdict(function: JudgedFunction, errors: Mapping[str, Array]) -> Verdict:
    """The verdict by these errors, or by exact values where they decide."""
    right = function.right_where_answered if function.decided_by_proof else function.within(errors)
    return verdict_of(right, function.decided)


def _read(judgment: Judgment) -> tuple[Block, ...]:
    """The conventions that the functions follow, and the states without an answer."""
    functions = judgment.functions.values()
    followed = tuple(
        (function.name, ", ".join(f"{name}: {way}" for name, way in function.conventions.items()))
        for function in functions
        if function.conventions
    )
    failed = tuple(
        (function.name, _states([failure.number + 1 for failure in function.failures]))
        for function in functions
        if function.failures
    )
    return (
        *([Facts(followed, title="Conventions that the answers follow")] if followed else []),
        *([Facts(failed, title="States without an answer")] if failed else []),
    )


def _states(numbers: list[int]) -> str:
    """state 3; states 3, 7, 8"""
    return f"state{'s' if len(numbers) > 1 else ''} {first_of(numbers, MAX_LISTED_STATES)}"


def _largest(errors: Mapping[str, Array], reference: str) -> float | None:
    return float(infinite_where_nan(errors[reference]).max()) if reference in errors else None


def _to_be_known(judgment: Judgment) -> Notes:
    return Notes(tuple(map(Note, judgment.notes)), title="To be known")


def _judged(judgment: Judgment) -> tuple[Block, ...]:
    model, names = judgment.model, judgment.joint_names
    facts = (
        ("robot", f"{judgment.robot}: {counted(len(names), 'joint')}{reading_text(judgment.locked, judgment.chain)}"),
        ("joint order", ", ".join(names)),
        ("states", f"{judgment.samples} random states and special ones, seed {judgment.seed}"),
        ("reference implementations", ", ".join(judgment.references)),
    )
    return robot_picture(model, Path(judgment.robot).name), Group((Facts(facts), joints_table(model)))
