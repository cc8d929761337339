"""The errors of all codes against exact values, as a report."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from crosscheck.commands.crosscheck.exact.record import record
from crosscheck.commands.crosscheck.report import scales_section
from crosscheck.comparing.accuracy import PINOCCHIO, QuantityErrors, TrueErrors, over_robots
from crosscheck.report.error_tables import verdict_of
from crosscheck.report.pictures.error_points import ErrorRow, error_points
from crosscheck.report.report import (
    NO_VALUE,
    Block,
    Column,
    Facts,
    Note,
    Notes,
    Picture,
    Prose,
    Report,
    Row,
    Section,
    Table,
    Verdict,
)
from crosscheck.report.robot_parts import joints_table, reading_text, robot_picture
from graphdyn.errors import counted

EXACT_TITLE = "graphdyn and Pinocchio against exact values"

TRUTHS = {
    "model": "exact are the doubles of the model in memory, on which all codes work",
    "file": "exact are the decimals of the file",
}

QUANTILE_WORDS = "99 % quantile at random states"
THREE = "Of each code: median and 99 % quantile at random states, largest error at all states."


def accuracy_report(measured: Sequence[TrueErrors], failures: Sequence[Mapping[str, Any]] = ()) -> Report:
    """failures: robots that could not be measured: robot, message"""
    several = len(measured) > 1
    keys = [f"robot-{k}" for k in range(1, len(measured) + 1)]
    robots = [_section(one, key, detailed=not several) for one, key in zip(measured, keys, strict=True)]
    first: tuple[Block, ...] = (
        Notes(tuple(Note(f["message"], where=f["robot"], state="disagrees") for f in failures), on=("page",)),
        _verdicts(measured, keys),
        *((_closer(measured),) if several else ()),
    )
    return Report(
        EXACT_TITLE,
        _verdict(measured, failures),
        (Section("robots", "", first), *robots, *((_method(measured[0]), scales_section()) if measured else ())),
        partial(record, measured, failures),
    )


def _verdict(measured: Sequence[TrueErrors], failures: Sequence[Mapping[str, Any]]) -> Verdict:
    agreeing = sum(one.agrees for one in measured)
    if not measured:
        reason = "Nothing was measured."
    elif len(measured) == 1:
        quantities = measured[0].quantities.values()
        within = sum(not quantity.beyond for quantity in quantities)
        reason = f"The errors of all codes are within the bounds of {within} of {len(quantities)} quantities."
    else:
        reason = f"All codes are within all bounds on {agreeing} of {len(measured)} robots."
    if failures:
        reason += f" {len(failures)} could not be measured."
    if agreeing < len(measured):
        return Verdict("disagrees", "DISAGREES", reason, "A code errs by more than its bound.")
    if failures:
        return Verdict("undecided", "incomplete", reason, "Some robots could not be measured.")
    return Verdict("agrees", "agrees", reason, "No code errs by more than its bounds.")


def eps_text(x: float) -> str:
    """An error in eps, with two digits."""
    if not math.isfinite(x):
        return "∞" if x > 0 else NO_VALUE
    return f"{x:.0f}" if 100 <= x < 1000 else f"{x:.1e}" if x >= 1000 or 0 < x < 1e-3 else f"{x:.2g}"


def _section(one: TrueErrors, key: str, *, detailed: bool) -> Section:
    """detailed: the terminal shows every quantity; otherwise it has what the robots have in common"""
    name = Path(one.robot).name
    return Section(
        key,
        name,
        (
            robot_picture(one.model, name),
            Facts(tuple(_facts(one)), title="What was measured", on=("page",)),
            joints_table(one.model),
            *([*_terminal_tables(one), Prose(THREE, on=("text",))] if detailed else []),
            _points(one),
            _table(one),
            Notes(tuple(_notes(one)), title="Notes"),
        ),
        verdict_of(one.agrees, reason=_what(one)),
        sheet=True,
        folded="" if detailed or not one.agrees else f"{name}: picture, joints, every quantity",
    )


def _what(one: TrueErrors) -> str:
    path = f"{one.robot}: " if one.robot != Path(one.robot).name else ""
    return (
        f"{path}{counted(one.n_bodies, 'joint')}{reading_text(one.locked, one.chain)}; {one.samples} random states and "
        f"the special ones, seed {one.seed}; {TRUTHS[one.truth]}"
    )


def _facts(one: TrueErrors) -> Iterator[tuple[str, str]]:
    yield "robot", one.robot
    yield "truth", TRUTHS[one.truth]
    yield "states", f"{one.samples} random ones and the special ones, seed {one.seed}"
    yield "recursive", "compiled at the random states" if one.compiled else "on NumPy"


def _terminal_tables(one: TrueErrors) -> Iterator[Table]:
    """One row per quantity, codes beside each other; those that few quantities have in a table of their own."""
    quantities = list(one.quantities.values())
    codes = dict.fromkeys(code for quantity in quantities for code in quantity.codes)
    usual = [code for code in codes if all(code in quantity.codes for quantity in quantities)]
    for shown in (usual, [code for code in codes if code not in usual]):
        having = [quantity for quantity in quantities if set(shown) & set(quantity.codes)]
        yield Table(
            (Column("error [eps]", "name"), Column("bound", "number"), *(Column(code, "number") for code in shown)),
            tuple(
                Row(
                    (quantity.name, eps_text(quantity.bound), *(_three(quantity, code) for code in shown)),
                    "disagrees" if quantity.beyond else "plain",
                )
                for quantity in having
            ),
            repeated=2,
            compact=True,
            on=("text",),
        )


def _three(quantity: QuantityErrors, code: str) -> str | None:
    """Median, 99 % quantile and largest error."""
    if code not in quantity.codes:
        return None
    found = quantity.codes[code]
    numbers = "".join(f"{eps_text(x):>8}" for x in (found.median, found.quantile_99, found.largest))
    return f"{numbers}{' ✗' if code in quantity.beyond else ''}"


def _table(one: TrueErrors) -> Table:
    """One row for each quantity and code."""
    rows = []
    for name, quantity in one.quantities.items():
        for k, (code, found) in enumerate(quantity.codes.items()):
            ratio = quantity.ratios(code, PINOCCHIO)[0] if code != PINOCCHIO else None
            verdict = verdict_of(code not in quantity.beyond)
            cells = (
                name, code, verdict, found.median, found.quantile_99, ratio, found.largest, quantity.bound,
                found.worst_case, found.quantile_99_of_values, quantity.scale,
            )  # fmt: skip
            rows.append(Row(cells, verdict.state, rule=k == 0))
    number: dict[str, Any] = {"kind": "number", "form": eps_text}
    return Table(
        (
            Column("quantity", "name"),
            Column("code"),
            Column("verdict", "verdict"),
            Column("median", **number),
            Column("99 %", **number),
            Column("over Pinocchio's", meaning="99 % quantile over that of Pinocchio", **number),
            Column("largest", meaning="at all states", **number),
            Column("bound", **number),
            Column("largest at"),
            Column("99 % of values", meaning="relative to the largest exact value at each state", **number),
            Column("scale", meaning="its terms are explained at the end of the page"),
        ),
        tuple(rows),
        title="Every quantity",
        folded=one.agrees,
        caption="Errors in eps = 2.2e-16 of the scale of the quantity",
        on=("page",),
    )


def _points(one: TrueErrors) -> Picture:
    rows = [
        ErrorRow(
            name, {code: (found.quantile_99, found.largest) for code, found in quantity.codes.items()}, quantity.bound
        )
        for name, quantity in one.quantities.items()
    ]
    caption = (
        f"Points: {QUANTILE_WORDS}; the line ends at the largest error of all states. The upright line is the bound."
    )
    draw = partial(error_points, rows=rows, usual=f"Errors ({QUANTILE_WORDS})")
    return Picture(draw, caption, title="Errors beside the bounds", on=("page",), folded=one.agrees)


def _notes(one: TrueErrors) -> Iterator[Note]:
    names: dict[str, list[str]] = {}
    for name, reason in one.not_measured.items():
        names.setdefault(reason, []).append(name)
    for reason, group in names.items():
        yield Note(f"not measured: {', '.join(group)}: {reason}")
    for case, count in one.not_regular.items():
        yield Note(
            f"{count} of the states '{case}': the mass matrix is not proven regular, or is singular in double "
            "precision; forward dynamics left out there"
        )
    yield from map(Note, one.notes)


def _verdicts(measured: Sequence[TrueErrors], keys: Sequence[str]) -> Table:
    """One row per robot."""
    rows = []
    for one, key in zip(measured, keys, strict=True):
        verdict = verdict_of(one.agrees)
        beyond = [f"{name} ({', '.join(q.beyond)})" for name, q in one.quantities.items() if q.beyond]
        left_out = sum(one.not_regular.values())
        cells = (Path(one.robot).name, verdict, one.n_bodies, len(one.quantities), left_out, ", ".join(beyond) or None)
        rows.append(Row(cells, verdict.state, link=key))
    return Table(
        (
            Column("robot", "name"),
            Column("verdict", "verdict"),
            Column("joints", "number"),
            Column("quantities", "number"),
            Column("states not regular", "number"),
            Column("beyond the bound"),
        ),
        tuple(rows),
        on=("text", "page") if len(measured) > 1 else ("page",),
    )


def _closer(measured: Sequence[TrueErrors]) -> Table:
    """The errors of graphdyn over those of Pinocchio, of all robots together."""
    found = over_robots(measured)
    methods = list(dict.fromkeys(code for ratios in found.values() for code in ratios))
    rows = []
    for name, ratios in found.items():
        cells = [f"{eps_text(r.mean)}; {eps_text(r.largest)}" if (r := ratios.get(code)) else None for code in methods]
        rows.append(Row((name, *cells)))
    return Table(
        (Column("error over Pinocchio's", "name"), *(Column(code, "number") for code in methods)),
        tuple(rows),
        title="Who is closer to the truth",
        caption="99 % quantile over that of Pinocchio: geometric mean over the robots; largest. Below 1: closer",
    )


def _method(one: TrueErrors) -> Section:
    text = (
        f"Errors are in eps = 2.2e-16 of the scale that the cross-check's bounds have (docs/notation.md). "
        f"{TRUTHS[one.truth][0].upper()}{TRUTHS[one.truth][1:]} (docs/exact.md). Each error is a proven lower bound, "
        "and true to more than ten digits."
    )
    return Section("method", "What the numbers are", (Prose(text),))
