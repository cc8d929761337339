"""One compared robot: verdict, what was compared, conditioning, every quantity, errors over states, worst states."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from crosscheck.comparing.comparison import Comparison, QuantityResult
from crosscheck.report.error_tables import ERROR_FORMAT, distribution, error_text, over_states, span_text, verdict_of
from crosscheck.report.pictures.spread import SpreadRow
from crosscheck.report.report import (
    WIDE_LINE_CHARACTERS,
    Block,
    Code,
    Column,
    Facts,
    Group,
    Hover,
    Note,
    Notes,
    Prose,
    Row,
    Section,
    Table,
)
from crosscheck.report.robot_parts import joints_table, reading_text, robot_picture
from crosscheck.report.snippets import worst_state
from graphdyn.errors import counted
from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS

ROUTES = {"urdf": "urdf: Pinocchio builds the same file", "model": "model: Pinocchio is built from our model"}

N_PLOTTED, N_SWITCHED_ON = 8, 3
"""Quantities whose errors are plotted, those nearest to their bounds, and how many of them before a reader asks."""

READER_NOTE = "Pinocchio's reader wrote: "
"""Begins the notes of what Pinocchio printed while it read the file."""


N_NEAREST = 10
"""Quantities that a page shows unasked: those that disagree, or of all, those nearest to their bounds."""


def robot_section(comparison: Comparison, key: str, *, detailed: bool) -> Section:
    """detailed: the terminal shows every quantity; otherwise it has them side by side with those of other robots, and
    the page shows no more of one that agrees than is asked for
    """
    name = Path(comparison.robot).name
    notes = (*_not_compared(comparison), *map(_note, comparison.notes))
    return Section(
        key,
        name,
        (
            robot_picture(comparison.model, name),
            Group((_compared(comparison), joints_table(comparison.model)), on=("page",)),
            Group((_conditioning(comparison), _base_parameters(comparison)), on=("page",)),
            *quantities_tables(comparison, terminal=detailed),
            *(Prose(line, on=("text",)) for line in _conditioning_lines(comparison)),
            Notes(notes, title="Notes"),
            *_distribution(comparison),
            *_worst_states(comparison),
        ),
        verdict_of(comparison.agrees, reason=_what(comparison)),
        sheet=True,
        folded=f"{name}: picture, joints, every quantity, worst states" if comparison.agrees and not detailed else "",
    )


def _what(comparison: Comparison) -> str:
    """Size, states and routes in one line; the path of the file where the title has its name alone."""
    path = f"{comparison.robot}: " if comparison.robot != Path(comparison.robot).name else ""
    return (
        f"{path}{counted(comparison.n_bodies, 'joint')}{reading_text(comparison.locked, comparison.chain)}; "
        f"{comparison.samples} random states and the special ones, seed {comparison.seed}; "
        f"routes: {', '.join(comparison.routes)}"
    )


def _compared(comparison: Comparison) -> Facts:
    items = (
        ("robot", comparison.robot),
        *(("route", ROUTES[route]) for route in comparison.routes),
        ("states", f"{comparison.samples} random ones and the special ones, seed {comparison.seed}"),
    )
    return Facts(items, title="What was compared")


def _conditioning(comparison: Comparison) -> Table:
    c, n = comparison.conditioning, comparison.n_bodies
    return Table(
        (
            Column("matrix", "name"),
            Column("rank", "number", form=span_text),
            Column("full rank", "number"),
            Column("condition number", "number", form=span_text),
        ),
        (
            Row(("φ_q, constraints", c.constraint_rank, JOINT_CONSTRAINTS * n, c.constraint_condition)),
            Row(("KKT, Eq. (111)", c.kkt_rank, (BODY_DOF + JOINT_CONSTRAINTS) * n, c.kkt_condition)),
            Row(("M, mass matrix", None, n, c.mass_matrix_condition)),
        ),
        title="How well conditioned it is",
        caption="Smallest and largest over all states",
    )


def _conditioning_lines(comparison: Comparison) -> Iterator[str]:
    """The same, and the base parameters."""
    c, n = comparison.conditioning, comparison.n_bodies
    rows, size = JOINT_CONSTRAINTS * n, (BODY_DOF + JOINT_CONSTRAINTS) * n
    yield (
        f"rank φ_q {span_text(c.constraint_rank)} of {rows}, cond {span_text(c.constraint_condition)}; "
        f"rank KKT {span_text(c.kkt_rank)} of {size}, cond {span_text(c.kkt_condition)}; "
        f"cond M {span_text(c.mass_matrix_condition)}"
    )
    if comparison.identification is not None:
        i = comparison.identification
        yield f"base parameters: {i.rank} (Pinocchio's regressor: {i.rank_there}), cond {i.condition_number:.3g}"


def _base_parameters(comparison: Comparison) -> Block:
    found = comparison.identification
    if found is None:
        return Prose("Not identified: the robot has no mass.", title="Base parameters")
    items = (
        ("number", f"{found.rank} with our regressor, {found.rank_there} with Pinocchio's"),
        ("condition number", f"{found.condition_number:.3g}"),
        ("pivots", f"smallest kept {error_text(found.gap[0])}, largest left out {error_text(found.gap[1])}"),
        (
            "difference",
            f"{error_text(found.difference)} between the estimates, {error_text(found.error)} from the model's own",
        ),
    )
    return Facts(items, title="Base parameters")


def _not_compared(comparison: Comparison) -> list[Note]:
    """One note per reason."""
    names: dict[str, list[str]] = {}
    for name, reason in comparison.not_compared.items():
        names.setdefault(reason, []).append(name)
    return [Note(f"not compared: {', '.join(group)}: {reason}") for reason, group in names.items()]


def _note(text: str) -> Note:
    return Note(text, "pinocchio-reader" if text.startswith(READER_NOTE) else "")


def quantities_tables(comparison: Comparison, *, terminal: bool) -> tuple[Block, ...]:
    """On the page those nearest to their bounds, or farthest beyond, and folded every quantity; terminal: there too."""
    every = quantities_table(comparison)
    if len(every.rows) <= N_NEAREST:
        return (replace(every, on=("text", "page") if terminal else ("page",)),)
    results = comparison.quantities
    worst = sorted(range(len(results)), key=lambda k: list(results.values())[k].part_of_bound, reverse=True)[:N_NEAREST]
    said = "nearest to their bounds" if comparison.agrees else "farthest beyond their bounds, or nearest to them"
    few = replace(
        every,
        rows=tuple(every.rows[k] for k in worst),
        caption=f"The {N_NEAREST} quantities {said}: largest relative errors",
        on=("page",),
    )
    title = f"Every quantity: {len(every.rows)}"
    return (
        *([replace(every, on=("text",))] if terminal else []),
        few,
        replace(every, title=title, folded=True, on=("page",)),
    )


def quantities_table(comparison: Comparison) -> Table:
    """Every quantity."""
    rows = []
    for name, result in comparison.quantities.items():
        quantity, verdict = result.quantity, verdict_of(result.agrees)
        where = f"{result.worst.case} ({result.worst.route})" if result.worst else "all states"
        bound = Hover(quantity.tolerance.bound, quantity.tolerance.why)
        cells = (name, verdict, result.max_relative_error, bound, quantity.against, where, quantity.scale)
        rows.append(Row(cells, verdict.state))
    return Table(
        (
            Column("quantity", "name"),
            Column("verdict", "verdict"),
            Column("error", **ERROR_FORMAT),
            Column("bound", **ERROR_FORMAT),
            Column("against Pinocchio's", from_width=WIDE_LINE_CHARACTERS),
            Column("worst at", from_width=WIDE_LINE_CHARACTERS),
            Column(
                "scale", from_width=2 * WIDE_LINE_CHARACTERS, meaning="its terms are explained at the end of the page"
            ),
        ),
        tuple(rows),
        caption="Largest relative errors over all routes and states",
    )


def _distribution(comparison: Comparison) -> tuple[Block, ...]:
    """Distribution of all quantities, and over the states those nearest to their bounds."""
    results = sorted(comparison.quantities.values(), key=lambda result: result.agrees)
    bounded = [result for result in results if result.quantity.tolerance.bound and result.worst]
    nearest = sorted(bounded, key=lambda result: result.part_of_bound, reverse=True)[:N_PLOTTED]
    return (
        replace(
            distribution([SpreadRow(r.quantity.name, r.errors, r.quantity.tolerance.bound) for r in results]),
            folded=comparison.agrees,
        ),
        *over_states(
            {result.quantity.name: result.errors / result.quantity.tolerance.bound for result in nearest},
            1.0,
            "error as part of its bound",
            "state, case after case",
            f"The {len(nearest)} quantities nearest to their bounds, on every route.",
            N_SWITCHED_ON,
        ),
    )


def _worst_states(comparison: Comparison) -> tuple[Block, ...]:
    """Python that shows both sides: the quantity nearest to its bound, or farthest beyond it, first."""
    by_margin = sorted(comparison.quantities.values(), key=lambda result: result.part_of_bound, reverse=True)
    found = [(result, text) for result in by_margin if (text := worst_state(comparison, result)) is not None]
    if not found:
        return ()
    result, text = found[0]
    where = "the nearest to" if result.agrees else "the farthest beyond"
    given = "" if comparison.file else ", with the robot in model"
    words = f"Of all single states, {where} a bound: {_worst_words(result)}. This shows both sides{given}:"
    others = tuple(Code(text, title=_worst_words(result), folded=True) for result, text in found[1:])
    return (
        Prose(words, title="The worst state", on=("page",)),
        Code(text, on=("page",)),
        Group(others, title="Worst states of the other quantities", on=("page",), folded=True),
    )


def _worst_words(result: QuantityResult) -> str:
    assert result.worst is not None
    return (
        f"{result.quantity.name}, {error_text(result.max_relative_error)} with the bound "
        f"{error_text(result.quantity.tolerance.bound)}, {result.worst.case} ({result.worst.route})"
    )
