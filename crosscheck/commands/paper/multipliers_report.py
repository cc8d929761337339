"""Section 3.2 of the paper, as printed and corrected, as sections of the report."""

from __future__ import annotations

from itertools import groupby

from crosscheck.commands.paper.texts import misprints, multiplier_text, printed_text
from crosscheck.paper.checks import WHY_CORRECTED
from crosscheck.paper.corrected import CorrectedMultipliers
from crosscheck.paper.multipliers import WHY_PRINTED, Multiplier, printed_ratios
from crosscheck.paper.reproduction import Reproduction
from crosscheck.report.report import Column, Note, Notes, Prose, Row, Section, Table

COMPONENTS = (("λ_1", "N"), ("λ_2", "N"), ("λ_3", "N"), ("λ_4", "N m"), ("λ_5", "N m"))


def printed_section(found: Reproduction) -> Section:
    ranks = ", ".join(f"{rank} at {time:g} s" for time, rank in found.over_time.ranks.items())
    rank = f"Rank of the printed rows: {found.printed.rank} of {found.printed.n_rows} at 1.5 s; {ranks}."
    blocks = Prose(WHY_PRINTED), Prose(rank), _multipliers(found.numbers), _ratios(found)
    return Section("printed", "Section 3.2 as printed", blocks)


def corrected_section(found: CorrectedMultipliers) -> Section:
    reading = Notes(tuple(Note(f"{sentence}.") for sentence in found.reading), title="What each joint carries at 1.5 s")
    return Section("corrected", "Section 3.2 corrected", (Prose(WHY_CORRECTED), _corrected(found), reading))


def _multipliers(numbers: tuple[Multiplier, ...]) -> Table:
    rows = [
        Row((one.name, printed_text(one.printed), multiplier_text(one), one.digits or "", one.meaning), rule=k == 0)
        for _, joint in groupby(numbers, lambda number: number.joint)
        for k, one in enumerate(joint)
    ]
    caption = "Eq. (113)-(118) at 1.5 s [N, N m]; digits: significant ones that agree, of seven. "
    return Table(
        (
            Column("multiplier", "name"),
            Column("printed", "number"),
            Column("graphdyn", "number"),
            Column("digits", "number"),
            Column("what it is"),
        ),
        tuple(rows),
        caption=caption + misprints(number.printed for number in numbers),
        compact=True,
    )


def _ratios(found: Reproduction) -> Table:
    columns = (
        Column("joint", "name"),
        Column("printed", "number", form=".7f"),
        Column("null vector", "number", form=".7f", meaning="of the two rows"),
    )
    rows = (Row((str(joint), ratio, found.printed.ratios.get(joint))) for joint, ratio in printed_ratios().items())
    title = "What the undetermined multipliers have in common"
    return Table(columns, tuple(rows), title=title, caption="λ_j4 / λ_j5; tan 33.75° = 0.6681786", compact=True)


def _corrected(found: CorrectedMultipliers) -> Table:
    rows = []
    for j, (ours, there) in enumerate(zip(found.multipliers, found.rnea, strict=True), start=1):
        rows += [Row((str(j), "graphdyn", *ours), rule=True), Row(("", "rnea", *there))]
    columns = (Column(name, "number", unit, ".3f") for name, unit in COMPONENTS)
    return Table(
        (Column("joint", "name"), Column("source", "name"), *columns),
        tuple(rows),
        caption="All thirty multipliers at 1.5 s beside those of Pinocchio's rnea; largest relative difference "
        f"{found.difference:.1e}",
        repeated=2,
        compact=True,
    )
