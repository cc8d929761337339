"""`graphdyn errata`: what the printed errors of the paper do, as a report."""

from __future__ import annotations

from collections.abc import Sequence

from crosscheck.commands.errata.record import record
from crosscheck.paper.errata import ERRATA, Effect
from crosscheck.report.report import Column, Facts, Report, Row, Section, Table

MEANINGS = Facts(tuple(ERRATA.items()))
"""What each erratum is."""


def errata_report(effects: Sequence[Effect], samples: int, seed: int) -> Report:
    title = "The printed errors, measured"
    blocks = effects_table(effects, samples, seed), MEANINGS
    return Report(title, None, (Section("errata", title, blocks),), record=lambda _: record(effects))


def effects_table(effects: Sequence[Effect], samples: int, seed: int) -> Table:
    """One row per erratum, robot and, for A3, distance from gimbal lock."""
    columns = (
        Column("erratum", "name"),
        Column("robot", "name"),
        Column("measured"),
        Column("median", "number", form=".2g"),
        Column("90 %", "number", form=".2g"),
        Column("largest", "number", form=".2g"),
        Column("corrected", "number", form=".2g", meaning="largest error of the corrected form"),
    )
    rows = tuple(
        Row((e.erratum, e.robot, e.measure, e.median, e.upper, e.largest, e.corrected), rule=k > 0 and new_robot)
        for k, e in enumerate(effects)
        for new_robot in [e.robot != effects[k - 1].robot]
    )
    caption = (
        f"Quantiles of the printed form ({samples} random states, seed {seed}), and the largest error of the corrected "
        "one"
    )
    return Table(columns, rows, caption=caption)
