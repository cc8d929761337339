"""The rows of a sweep as a table for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from crosscheck.report.summary import Row, short_names


def table(rows: Sequence[Row]) -> Table:
    """One row per robot; what is too wide is folded, so that nothing is lost."""
    rendered = Table()
    rendered.add_column("robot", overflow="fold", ratio=2)
    rendered.add_column("verdict", max_width=len("kinematics"))
    rendered.add_column("routes", no_wrap=True)
    rendered.add_column("nearest its bound", overflow="fold", ratio=2)
    rendered.add_column("error", justify="right", no_wrap=True)
    rendered.add_column("bound", justify="right", no_wrap=True)
    rendered.add_column("reason", overflow="fold", ratio=4)
    for name, row in zip(short_names(rows), rows, strict=True):
        numbers = (row.nearest or "–", _error(row.error), _error(row.bound))
        rendered.add_row(name, row.verdict, _routes(row.routes), *numbers, row.reason)
    return rendered


def _routes(routes: Sequence[str]) -> str:
    return "both" if len(routes) > 1 else "".join(routes) or "–"


def _error(value: float | None) -> str:
    return "–" if value is None else f"{value:.1e}"
