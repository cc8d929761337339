"""`graphdyn recording` as a report: what each column is, the columns drawn, the mapping."""

from __future__ import annotations

from functools import partial

import numpy as np

from crosscheck.commands.recording.record import record
from crosscheck.recordings import RecognizedLog
from crosscheck.report.report import (
    Block,
    Code,
    Column,
    Note,
    Notes,
    Panel,
    Plot,
    Report,
    Row,
    Section,
    Series,
    Table,
    Verdict,
)
from graphdyn.errors import counted

QUANTITY_NAMES = {
    "q": "positions",
    "v": "velocities",
    "a": "accelerations",
    "tau": "torques",
    "temperature": "temperatures",
    "": "–",
}


def recording_report(found: RecognizedLog, following: str) -> Report:
    """following: the command that uses the mapping"""
    verdict = Verdict(
        "agrees", "recognized", f"{counted(found.rows, 'row')}; the mapping is complete.", "The columns are recognized."
    )
    if found.open:
        left = " and ".join(choice.quantity for choice in found.open)
        verdict = Verdict(
            "undecided",
            "not yet",
            f"{counted(found.rows, 'row')}; left to be said: {left}.",
            "Some columns are not recognized.",
        )
    sections = [
        Section("columns", "The columns", (_columns(found), _others(found), *_left(found))),
        Section("mapping", "The mapping", (Code(found.mapping), *_following(found, following))),
        Section("curves", "The columns over time", (_curves(found),)),
    ]
    return Report(", ".join(found.files), verdict, tuple(sections), record=partial(record, found))


def _columns(found: RecognizedLog) -> Table:
    rows = [
        Row((_use(clock.taken), "time", ", ".join(map(str, clock.columns)), clock.unit, None, clock.why))
        for clock in found.clocks
    ]
    if not found.clocks and found.rate is not None:
        rows.append(Row((_use(True), "time", None, "Hz", None, f"{found.rate:g} samples per second")))
    rows += [
        Row((
            _use(block.taken), QUANTITY_NAMES[block.quantity], block.label, block.unit or None, block.side or None,
            block.why,
        ))
        for block in found.blocks
    ]  # fmt: skip
    return Table(
        (
            Column("", "verdict"),
            Column("what", "name"),
            Column("columns"),
            Column("unit"),
            Column("side"),
            Column("why"),
        ),
        tuple(rows),
        caption="* stands for the joint or its number",
        failures_first=False,
    )


def _use(taken: bool) -> Verdict:
    return Verdict("agrees", "taken") if taken else Verdict("plain", "not taken")


def _others(found: RecognizedLog) -> Notes:
    notes = tuple(Note(f"{name}: {why}") for name, why in found.others.items())
    return Notes(notes, title="Columns without meaning", folded=True)


def _left(found: RecognizedLog) -> list[Block]:
    notes = [Note(f"assumed: {text}", state="undecided") for text in found.assumed]
    for choice in found.open:
        notes.append(Note(f"{choice.quantity}: {choice.question}; {' or '.join(choice.options)}", state="undecided"))
    return [Notes(tuple(notes))]


def _following(found: RecognizedLog, following: str) -> tuple[Block, ...]:
    if found.complete:
        return (Code(following, title="The command that uses it"),)
    return (Notes((Note("Give the options above, or complete the file; then:"),)), Code(following))


def _curves(found: RecognizedLog) -> Plot:
    """One panel for each block, all over the same rows."""
    clock = next((clock for clock in found.clocks if clock.taken), None)
    t = np.arange(found.rows) / (found.rate or 1.0)
    if clock is not None:
        since = np.maximum.accumulate(np.nan_to_num(clock.values))
        size = np.median(np.diff(clock.values)) * clock.rate
        t = (since - since[0]) / (size or 1.0)
    panels = tuple(
        Panel(
            f"{QUANTITY_NAMES[block.quantity]}, {block.label}" if block.quantity else block.label,
            tuple(Series(name, block.values[:, j], color=j) for j, name in enumerate(found.joints)),
            block.unit,
        )
        for block in found.blocks
    )
    return Plot(t, "t [s]" if found.rate else "row", panels, f"Columns of {', '.join(found.files)}", on=("page",))
