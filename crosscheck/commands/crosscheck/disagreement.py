"""What is said where a robot disagrees, in short: the quantities beyond their bounds, and the numbers of one of them.

For test suites, whose readers see the end of a message first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from crosscheck.commands.crosscheck.robot_report import quantities_table
from crosscheck.comparing.both_sides import both_sides
from crosscheck.comparing.comparison import Comparison, QuantityResult
from crosscheck.report.plain_text import vector_text
from crosscheck.report.report import Block, Column, Facts, Prose, Report, Row, Section, Table, Verdict

MAX_ENTRIES = 6
"""Entries of an answer that are shown, those that differ most."""


def disagreement_report(comparison: Comparison) -> Report:
    """Every quantity beyond its bound; both sides of the first of them, since others follow from it."""
    table = quantities_table(comparison)
    beyond = [result for result in comparison.quantities.values() if not result.agrees]
    rows = tuple(row for row in table.rows if row.state == "disagrees")
    blocks = (replace(table, rows=rows), *_difference(comparison, beyond))
    reason = f"{len(beyond)} of {len(comparison.quantities)} quantities are beyond their bounds."
    return Report(
        f"graphdyn and Pinocchio on {Path(comparison.robot).name}",
        Verdict("disagrees", "DISAGREES", reason),
        (Section("beyond", "", blocks),),
    )


def _difference(comparison: Comparison, beyond: Sequence[QuantityResult]) -> tuple[Block, ...]:
    found = ((result, both_sides(comparison, result)) for result in beyond)
    result, sides = next(((result, sides) for result, sides in found if sides is not None), (beyond[0], None))
    worst = result.worst
    if sides is None or worst is None:
        return ()
    ours, theirs = sides
    with np.errstate(all="ignore"):  # of infinities
        difference = ours - theirs
    apart = np.abs(difference)
    order = np.argsort(np.where(np.isnan(apart), np.inf, apart), axis=None)[::-1][:MAX_ENTRIES]
    rows = []
    for k in sorted(order.tolist()):
        place = np.unravel_index(k, ours.shape)
        entry = f"[{', '.join(str(int(i)) for i in place)}]" if place else ""
        rows.append(Row((entry, float(ours[place]), float(theirs[place]), float(difference[place]))))
    state = [(name, vector_text(getattr(worst, name))) for name in ("q", "v", "a")]
    table = Table(
        (
            Column("entry"),
            Column("graphdyn", "number", form=".10g"),
            Column("Pinocchio", "number", form=".10g"),
            Column("difference", "number", form="+.2e"),
        ),
        tuple(rows),
        title=f"{result.quantity.name} where its error is largest: {worst.case}, route {worst.route}",
        caption=f"The {len(rows)} of {ours.size} entries that differ most" if len(rows) < ours.size else "",
    )
    return (
        table,
        Facts(tuple(state)),
        Prose("All quantities, and code that reproduces this: graphdyn crosscheck --html"),
    )
