"""Tables 3 and 4 of the paper beside graphdyn's identifications, as a section of the report."""

from __future__ import annotations

from functools import partial

from crosscheck.commands.paper.identification_errors import identification_errors
from crosscheck.commands.paper.texts import BODY_TABLE_COLUMNS, error_text, misprints, printed_text, value_text
from crosscheck.paper.identification import WHY_TABLE_3, PaperIdentification
from crosscheck.paper.printed import TABLE_3, TABLE_4
from crosscheck.report.report import WIDE_LINE_CHARACTERS, Column, Picture, Prose, Row, Section, Table

PARAMETER = (Column("parameter", "name"), Column("source", "name"), *BODY_TABLE_COLUMNS)


def identification_section(found: PaperIdentification) -> Section:
    blocks = Prose(WHY_TABLE_3), _values(found), _errors(found), _picture(found), _trials(found)
    return Section("identification", "Tables 3 and 4: identification", blocks)


def _values(found: PaperIdentification) -> Table:
    rows = []
    for k, (name, printed) in enumerate(TABLE_3.rows.items()):
        rows += [
            Row((name, "printed", *map(printed_text, printed)), rule=True),
            Row(("", "exact data", *map(value_text, found.exact.values[k]))),
            Row(("", "7 digits", *map(value_text, found.rounded[0].values[k]))),
        ]
    caption = (
        "Table 3 [kg, kg m²]; 7 digits: data rounded to the nearest; –: not determined by the data, or not printed. "
    )
    caption += misprints(number for row in TABLE_3.rows.values() for number in row)
    return Table(PARAMETER, tuple(rows), title="Identified parameters", caption=caption, repeated=2, compact=True)


def _errors(found: PaperIdentification) -> Table:
    rows = []
    for k, (name, printed) in enumerate(TABLE_4.rows.items()):
        rows += [
            Row((name, "printed", *map(printed_text, printed)), rule=True),
            Row(("", "exact data", *map(error_text, found.exact.errors[k]))),
            Row(("", "7 digits", *map(value_text, found.rounded[0].errors[k]))),
        ]
    caption = "Table 4 [kg, kg m²], columns in the order of Table 3"
    return Table(PARAMETER, tuple(rows), title="Absolute errors", caption=caption, repeated=2, compact=True)


def _picture(found: PaperIdentification) -> Picture:
    seeds = len(found.rounded) - 2
    caption = (
        "The paper had seven digits of every measurement; how they fell is not known. The band holds two roundings of "
        f"the exact data and {seeds} seeds of noise of one ten-millionth of a channel before the rounding, the dot is "
        "the first of them. Left of the dashed line the axis is compressed."
    )
    return Picture(partial(identification_errors, found=found), caption, title="Error of every parameter")


def _trials(found: PaperIdentification) -> Table:
    """Largest and root mean square error over the entries that the data determine and the paper prints."""
    paper = Row(("Table 4", f"{found.printed_largest:.4f}", f"{found.printed_rms:.4f}", None, None, None))
    exact = [(trial, ".1e") for trial in (found.exact, found.together)]
    rounded = [(trial, ".4f") for trial in found.rounded]
    rows = (
        Row(
            (
                trial.data,
                format(trial.largest(found.compared), form),
                format(trial.rms(found.compared), form),
                trial.rank,
                trial.condition_number,
                ", ".join(trial.undetermined),
            )
        )
        for trial, form in (*exact, *rounded)
    )
    return Table(
        (
            Column("data", "name"),
            Column("largest error", "number"),
            Column("rms", "number"),
            Column("rank of 36", "number"),
            Column("condition number", "number", form=".3g", from_width=WIDE_LINE_CHARACTERS),
            Column("not determined", from_width=WIDE_LINE_CHARACTERS),
        ),
        (paper, *rows),
        title="All trials",
        caption=f"Over the {found.compared.sum()} entries that the data determine and the paper prints [kg, kg m²]",
        compact=True,
        folded=True,
    )
