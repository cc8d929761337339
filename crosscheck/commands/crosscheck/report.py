"""`graphdyn crosscheck`: one robot or several against Pinocchio, as a report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from crosscheck.commands.crosscheck.record import record
from crosscheck.commands.crosscheck.robot_report import robot_section
from crosscheck.comparing.comparison import Comparison, QuantityResult
from crosscheck.quantities import COMPARED, COUPLED, LOOPED
from crosscheck.report.error_tables import ERROR_FORMAT, error_text, verdict_of
from crosscheck.report.report import Column, Facts, Note, Notes, Prose, Report, Row, Section, State, Table, Verdict
from graphdyn.errors import counted

TITLE = "graphdyn against Pinocchio"


def crosscheck_report(comparisons: Sequence[Comparison], failures: Sequence[Mapping[str, Any]] = ()) -> Report:
    """failures: robots that could not be compared: robot, message"""
    several = len(comparisons) > 1
    keys = [f"robot-{k}" for k in range(1, len(comparisons) + 1)]
    robots = [robot_section(one, key, detailed=not several) for one, key in zip(comparisons, keys, strict=True)]
    first = (
        Notes(tuple(Note(f["message"], where=f["robot"], state="disagrees") for f in failures), on=("page",)),
        *((_overview(comparisons),) if several else ()),
        _verdicts(comparisons, keys),
    )
    return Report(
        TITLE if several or not comparisons else f"{TITLE} on {Path(comparisons[0].robot).name}",
        _verdict(comparisons, failures),
        (Section("robots", "", first), *robots, *((scales_section(),) if comparisons else ())),
        partial(record, comparisons, failures),
    )


def _verdict(comparisons: Sequence[Comparison], failures: Sequence[Mapping[str, Any]]) -> Verdict:
    agreeing = sum(comparison.agrees for comparison in comparisons)
    sentence = _sentence(comparisons, agreeing, failures)
    if not comparisons:
        reason = "Nothing was compared."
    elif len(comparisons) == 1:
        reason = f"{_within(comparisons[0])} quantities are within their bounds."
        if comparisons[0].not_compared:
            reason += f" {len(comparisons[0].not_compared)} were not compared."
    else:
        reason = f"{agreeing} of {len(comparisons)} robots agree on every quantity."
    if failures:
        reason += f" {len(failures)} could not be compared."
    if agreeing < len(comparisons):
        return Verdict("disagrees", "DISAGREES", reason, sentence)
    state: State = "undecided" if failures else "agrees"
    return Verdict(state, "incomplete" if failures else "agrees", reason, sentence)


def _sentence(comparisons: Sequence[Comparison], agreeing: int, failures: Sequence[Mapping[str, str]]) -> str:
    if len(comparisons) == 1 and not failures:
        name = Path(comparisons[0].robot).name
        return f"graphdyn and Pinocchio {'agree' if agreeing else 'disagree'} on {name}."
    wrong, number = len(comparisons) - agreeing, len(comparisons) + len(failures)
    if wrong:
        return f"graphdyn and Pinocchio disagree on {wrong} of {counted(number, 'robot')}."
    if failures:
        return f"{len(failures)} of {counted(number, 'robot')} could not be compared."
    return f"graphdyn and Pinocchio agree on all {number} robots."


def _verdicts(comparisons: Sequence[Comparison], keys: Sequence[str]) -> Table:
    """One row per robot, for the page."""
    rows = []
    for comparison, key in zip(comparisons, keys, strict=True):
        results = list(comparison.quantities.values())
        nearest = max(results, key=lambda result: result.part_of_bound)
        verdict = verdict_of(comparison.agrees)
        cells = (
            Path(comparison.robot).name, verdict, comparison.n_bodies, _within(comparison),
            nearest.quantity.name, nearest.max_relative_error, nearest.quantity.tolerance.bound,
        )  # fmt: skip
        rows.append(Row(cells, verdict.state, link=key))
    return Table(
        (
            Column("robot", "name"),
            Column("verdict", "verdict"),
            Column("joints", "number"),
            Column("within bound", "number"),
            Column("nearest to, or beyond, its bound"),
            Column("error", **ERROR_FORMAT),
            Column("bound", **ERROR_FORMAT),
        ),
        tuple(rows),
        caption="The verdict on every robot",
        on=("page",),
    )


def _within(comparison: Comparison) -> str:
    """How many quantities are within their bounds."""
    results = comparison.quantities.values()
    return f"{sum(result.agrees for result in results)} of {len(results)}"


def _overview(comparisons: Sequence[Comparison]) -> Table:
    """Quantities by robots, for the terminal."""
    rows = []
    for name, quantity in {**COMPARED, **COUPLED, **LOOPED}.items():
        results = [comparison.quantities.get(name) for comparison in comparisons]
        if any(results):
            agrees = all(result.agrees for result in results if result)
            cells = (name, f"{quantity.tolerance.bound:.1e}", *map(_marked, results))
            rows.append(Row(cells, "plain" if agrees else "disagrees"))
    verdicts = (verdict_of(comparison.agrees) for comparison in comparisons)
    return Table(
        (
            Column("largest relative error", "name"),
            Column("bound", "number"),
            *(Column(Path(comparison.robot).name, "number") for comparison in comparisons),
        ),
        (*rows, Row(("verdict", "", *verdicts), rule=True)),
        repeated=2,
        on=("text",),
    )


def _marked(result: QuantityResult | None) -> str | None:
    return None if result is None else f"{error_text(result.max_relative_error)}{'' if result.agrees else ' ✗'}"


def scales_section() -> Section:
    """What the names in the column of scales mean."""
    words = (
        "‖x − reference‖∞ of a state, over a scale that cannot vanish: the largest of the reference values and of the "
        "terms that are summed to get them. “Only” means that the scale is what is named and nothing else."
    )
    facts = (
        ("lever", "the farthest link origin from the base, plus the largest offset of a center of mass, plus 1 mm"),
        ("turn", "‖ω̇‖∞ + ‖ω‖∞² over all bodies"),
        ("swing", "turn × lever + 2 ‖ω‖∞ ‖slide rate‖∞ + ‖slide acceleration‖∞"),
        ("compensated", "swing + ‖g‖, of gravity-compensated accelerations"),
        ("force", "compensated × total mass, plus the largest external force"),
        ("moment", "force × lever + largest tensor entry × turn, plus the largest external moment"),
    )
    short = (
        "Every error is relative to a scale that cannot vanish (docs/notation.md). "
        "Route urdf: Pinocchio builds the same file; route model: Pinocchio is built from graphdyn's model."
    )
    blocks = (Prose(short, on=("text",)), Prose(words, on=("page",)), Facts(facts, on=("page",)))
    return Section("scales", "How errors are measured", blocks)
