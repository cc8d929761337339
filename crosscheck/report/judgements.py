"""Judgements as text."""

from __future__ import annotations

import io

from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from crosscheck.judging.judgement import Diagnosis, Judgement

TEXT_WIDTH = 140
"""Characters of a line in the messages of assert_correct."""

VERDICTS = {(True, True): "agrees", (False, True): "DISAGREES"}


def verdict_of(judgement: Judgement) -> str:
    """agrees, DISAGREES, or UNDECIDED where the referees differ among themselves."""
    return VERDICTS.get((judgement.agrees, judgement.decided), "UNDECIDED")


def headline(judgement: Judgement) -> str:
    locked = f", locked: {', '.join(judgement.locked)}" if judgement.locked else ""
    return (
        f"{judgement.robot}: {verdict_of(judgement)} ({len(judgement.joint_names)} joints{locked}; "
        f"{judgement.samples} random states and special ones, seed {judgement.seed}; "
        f"referees: {', '.join(judgement.referees)})"
    )


def as_table(judgement: Judgement) -> RenderableType:
    """Errors against every referee, then what is wrong."""
    table = Table(title=headline(judgement), title_justify="left")
    table.add_column("function", no_wrap=True)
    for referee in judgement.referees:
        table.add_column(f"error against {referee}", justify="right")
    table.add_column("bound", justify="right", no_wrap=True)
    table.add_column("", no_wrap=True)
    for name, function in judgement.functions.items():
        errors = [function.errors.get(referee) for referee in judgement.referees]
        table.add_row(
            name,
            *("–" if error is None else f"{error.max():.1e}" for error in errors),
            f"{function.bound:.1e}",
            "agrees" if function.agrees else "DISAGREES",
        )
    lines = [*(_said(diagnosis) for diagnosis in judgement.diagnoses), *judgement.notes]
    return Group(table, *(Text(line) for line in lines))


def judgement_text(judgement: Judgement) -> str:
    """The table as plain text, for error messages and logs."""
    buffer = io.StringIO()
    Console(file=buffer, width=TEXT_WIDTH, markup=False).print(as_table(judgement))
    return buffer.getvalue()


def _said(diagnosis: Diagnosis) -> str:
    also = f"\n  the same numbers: {'; or '.join(diagnosis.also)}" if diagnosis.also else ""
    return (
        f"{diagnosis.function}: {diagnosis.message} [{diagnosis.kind}]\n"
        f"  shown by: {diagnosis.evidence}{also}\n  remedy: {diagnosis.remedy}"
    )
