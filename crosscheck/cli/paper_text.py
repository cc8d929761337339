"""The paper beside the corrected model, as tables for the terminal; in the order of the paper."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich import box
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from crosscheck.cli.errata import effects_table
from crosscheck.studies.errata import ERRATA
from crosscheck.studies.paper.checks import Check
from crosscheck.studies.paper.identification import WHY_TABLE_3, PaperIdentification
from crosscheck.studies.paper.multipliers import WHY_PRINTED, Multiplier, printed_ratios
from crosscheck.studies.paper.printed import TABLE_3, TABLE_4
from crosscheck.studies.paper.reproduction import Reproduction
from crosscheck.studies.paper.tables import WHY_TABLE_2, GeometryTable
from crosscheck.studies.paper.texts import error_text, multiplier_text, printed_text, value_text
from crosscheck.studies.paper.why import EXPERIMENT, WHY_CORRECTED, WHY_ERRATA

BODIES = tuple(f"B_{i}" for i in range(1, 7))

SHORT_KINDS = {
    "reproduced": "",
    "rounding": "zero; printed: rounding",
    "free": "not determined (A2)",
    "unexplained": "not reproduced",
}
"""What a multiplier is, in a column of the terminal."""


def text(found: Reproduction) -> Iterator[RenderableType]:
    """The parts in order; no line of a table is longer than 80 characters."""
    yield _title("Table 2: geometry and density")
    yield _geometry(found.geometry)
    yield _why(WHY_TABLE_2)
    yield _title("The experiment of section 3.1")
    yield _why(EXPERIMENT)
    yield _title("Table 3: identified parameters [kg, kg m²]; –: not determined by the data, or not printed")
    yield _values(found.identification)
    yield _title("Table 4: absolute errors [kg, kg m²]")
    yield _errors(found.identification)
    yield _trials(found.identification)
    yield _why(WHY_TABLE_3)
    yield _title("Section 3.2 as printed: Eq. (113)-(118) at 1.5 s")
    printed = found.printed
    yield Text(f"rank of the printed rows: {printed.rank} of {printed.n_rows}; {_ranks(found)}")
    yield _multipliers(found.numbers)
    yield _ratios(found)
    yield _why(WHY_PRINTED)
    yield _title("Section 3.2 corrected: all thirty multipliers at 1.5 s")
    yield _corrected(found)
    for sentence in found.corrected.reading:
        yield Text(sentence)
    yield _why(WHY_CORRECTED)
    yield _title(f"The printed errors, measured ({found.samples} random states, seed {found.seed})")
    yield effects_table(found.effects)
    for name, sentence in ERRATA.items():
        yield Text(f"{name}: {sentence}")
    yield _why(WHY_ERRATA)
    yield _title("What holds")
    yield _checks(found.checks)
    yield Text(
        "every reproduced number is within its bound" if found.agrees else "NOT every number is within its bound"
    )


def _title(title: str) -> Text:
    return Text(f"\n{title}", style="bold")


def _why(sentence: str) -> Text:
    return Text(f"\n{sentence}")


def _table(*columns: str, numbers: Sequence[str] = BODIES) -> Table:
    """Narrow, without frames; `numbers` columns are to the right."""
    table = Table(box=box.SIMPLE_HEAD, show_edge=False, padding=(0, 0), collapse_padding=True)
    for column in columns:
        right = column in numbers
        table.add_column(column, justify="right" if right else "left", overflow="fold", no_wrap=right)
    return table


def _geometry(found: GeometryTable) -> Table:
    table = _table("", "", *BODIES)
    for name, printed, ours in zip(found.rows, found.printed, found.texts, strict=True):
        table.add_row(name, "printed", *(number.text for number in printed))
        table.add_row("", "ours", *ours, end_section=True)
    return table


def _values(found: PaperIdentification) -> Table:
    table = _table("", "", *BODIES)
    for k, (name, row) in enumerate(TABLE_3.rows.items()):
        table.add_row(name, "printed", *map(printed_text, row))
        table.add_row("", "exact", *map(value_text, found.exact.values[k]))
        table.add_row("", "7 digits", *map(value_text, found.rounded[0].values[k]), end_section=True)
    return table


def _errors(found: PaperIdentification) -> Table:
    table = _table("", "", *BODIES)
    for k, (name, row) in enumerate(TABLE_4.rows.items()):
        table.add_row(name, "printed", *map(printed_text, row))
        table.add_row("", "exact", *map(error_text, found.exact.errors[k]))
        table.add_row("", "7 digits", *map(value_text, found.rounded[0].errors[k]), end_section=True)
    return table


def _trials(found: PaperIdentification) -> Table:
    """Largest and root mean square error over the entries that the data determine and the paper prints."""
    columns = ("largest error", "rms")
    table = _table(f"over {found.compared.sum()} entries", *columns, numbers=columns)
    table.add_row("Table 4", f"{found.printed_largest:.4f}", f"{found.printed_rms:.4f}")
    for trial in (found.exact, found.together):
        table.add_row(trial.data, f"{trial.largest(found.compared):.1e}", f"{trial.rms(found.compared):.1e}")
    for trial in found.rounded:
        table.add_row(trial.data, f"{trial.largest(found.compared):.4f}", f"{trial.rms(found.compared):.4f}")
    return table


def _ranks(found: Reproduction) -> str:
    return ", ".join(f"{rank} at {time:g} s" for time, rank in found.over_time.ranks.items())


def _multipliers(numbers: Sequence[Multiplier]) -> Table:
    columns = ("printed", "ours", "digits")
    table = _table("", *columns, "", numbers=columns)
    for number in numbers:
        misprint = f"minus not printed ({number.printed.erratum})" if number.printed.erratum else ""
        table.add_row(
            number.name,
            str(number.printed.text),
            multiplier_text(number),
            str(number.digits or ""),
            f" {SHORT_KINDS[number.kind] or misprint}",
            end_section=number.number == 5,
        )
    return table


def _ratios(found: Reproduction) -> Table:
    columns = ("printed", "null vector")
    table = _table("λ_j4 / λ_j5", *columns, numbers=columns)
    for joint, ratio in printed_ratios().items():
        table.add_row(f"joint {joint}", f"{ratio:.7f}", f"{found.printed.ratios.get(joint, float('nan')):.7f}")
    return table


def _corrected(found: Reproduction) -> Table:
    names = ("λ_1 [N]", "λ_2 [N]", "λ_3 [N]", "λ_4 [N m]", "λ_5 [N m]")
    table = _table("joint", "", *names, numbers=names)
    for j, (ours, there) in enumerate(zip(found.corrected.multipliers, found.corrected.rnea, strict=True), start=1):
        table.add_row(str(j), "ours", *(f"{value:.3f}" for value in ours))
        table.add_row("", "rnea", *(f"{value:.3f}" for value in there), end_section=True)
    return table


def _checks(checks: Sequence[Check]) -> Table:
    columns = ("measured", "bound")
    table = _table("where", "what", *columns, "", numbers=columns)
    for check in checks:
        sign = "≥" if check.at_least else "≤"
        verdict = " holds" if check.agrees else " DOES NOT HOLD"
        table.add_row(check.where, check.what, f"{check.measured:.2g}", f"{sign} {check.bound:.3g}", verdict)
    return table
