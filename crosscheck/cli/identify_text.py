"""An identification as tables for the terminal."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from crosscheck.identifying import Identified
from crosscheck.identifying.parameters import base_rows, body_rows, deviations_of
from crosscheck.identifying.recommending import mean_error, real
from graphdyn.identification import MethodResult, ResidualStatistics

MOST_NAMES = 6
"""Of a long list of parameters so many are printed; --json has all."""


def text(found: Identified, shown: MethodResult | None, width: int) -> Iterator[RenderableType]:
    """The tables in order, for a terminal this wide [characters]."""
    yield Text(_heading(found))
    yield _methods(found)
    yield from _remarks(found)
    yield from _errors(found, "held out")
    yield from _errors(found, "fitted")
    if shown is not None:
        yield from _parameters(found, shown)
        yield from _bodies(found, shown)
    yield from _undetermined(found)
    yield Text(verdict(found), style="bold")


def verdict(found: Identified) -> str:
    """The recommendation in one sentence."""
    chosen = found.recommendation
    return (
        f"\nno usable model: {chosen.reason}" if chosen.name is None else f"\nuse {chosen.name}: it is {chosen.reason}"
    )


def _heading(found: Identified) -> str:
    comparison, fit = found.comparison, found.division.fit
    files = ", ".join(fit.provenance.files)
    lines = [
        f"{found.subject.name}: {len(comparison.names)} parameters, {comparison.rank} base parameters determined of "
        f"{comparison.structural_rank} that any motion could determine, condition number "
        f"{comparison.condition_number:.3g}",
        f"fitted: {sum(map(len, found.fit.times))} rows of {files}; held out: {found.division.words}, "
        f"{sum(len(t) for trial in found.trials for t in trial.times)} rows",
    ]
    return "\n".join([*lines, *fit.provenance.steps])


def _methods(found: Identified) -> Table:
    table = Table(title="\nMethods", title_justify="left", caption_justify="left")
    table.caption = (
        "error: ‖e‖/‖τ‖ over the moving rows of each joint (all rows where it hardly moves), mean over joints"
    )
    table.add_column("method", overflow="fold")
    for column in ("held-out\nerror [%]", "links\nreal", "M positive\ndefinite", "smallest\neigenvalue", "time\n[s]"):
        table.add_column(column, justify="right")
    table.add_column("verdict", overflow="fold")
    for result in found.comparison.results:
        if result.failure is not None:
            table.add_row(result.name, "–", "–", "–", "–", f"{result.seconds:.2f}", "failed, see below")
            continue
        plausible = result.plausibility
        assert plausible is not None
        n, links = found.torque_model.model.n_bodies, int((plausible.pseudo_inertia_eigenvalues >= 0).sum())
        table.add_row(
            result.name,
            f"{100 * mean_error(result):.2f}",
            f"{links} of {n}",
            f"{plausible.positive_definite} of {len(plausible.mass_matrix_eigenvalues)}",
            f"{plausible.mass_matrix_eigenvalues.min():.2g}",
            f"{result.seconds:.2f}",
            "recommended" if result.name == found.recommendation.name else "" if real(result) else "no real robot",
        )
    return table


def _remarks(found: Identified) -> Iterator[RenderableType]:
    for result in found.comparison.results:
        said = [f"failed: {result.failure}"] if result.failure is not None else []
        if result.estimate is not None:
            said += result.estimate.remarks
        for remark in said:
            yield Text(f"{result.name}: {remark}")


def _errors(found: Identified, which: str) -> Iterator[RenderableType]:
    """RMS over all rows, and relative error over moving rows, per joint."""
    slow = which == "fitted" and np.any(np.asarray(found.preparation.min_speed) > 0)
    note = " / % of fitted rows" if slow else ""
    unit = "N m or N" if any(joint.is_prismatic for joint in found.torque_model.model.joints) else "N m"
    table = Table(title=f"\nErrors, {which}: RMS of all rows [{unit}] / % of moving rows{note}", title_justify="left")
    table.add_column("method", overflow="fold")
    for name in found.torque_model.model.joint_names:
        table.add_column(name, justify="right", overflow="fold")
    for result in found.comparison.results:
        statistics = result.held_out if which == "held out" else result.training
        if statistics is not None:
            cells = _cells(statistics)
            if slow:
                fitted = found.fitted_errors(result)
                cells = [f"{cell} / {100 * x:.1f}" for cell, x in zip(cells, fitted, strict=True)]
            table.add_row(result.name, *cells)
    if table.row_count:
        yield table


def _cells(statistics: ResidualStatistics) -> list[str]:
    pairs = zip(statistics.everything.rms, statistics.moving.relative, strict=True)
    return [f"{rms:.3g} / {'–' if np.isnan(part) else f'{100 * part:.1f}'}" for rms, part in pairs]


def _parameters(found: Identified, shown: MethodResult) -> Iterator[RenderableType]:
    _, source = deviations_of(found, shown)
    table = Table(title=f"\nBase parameters by {shown.name}", title_justify="left", caption_justify="left")
    table.caption = f"σ: {source}, for white noise; CAD: the robot as given, drives zero"
    table.add_column("base parameter", overflow="fold")
    rows, virtual = base_rows(found, shown), found.truth is not None
    blocks = any(np.isfinite(row.block_deviation) for row in rows)
    if blocks:
        table.caption += "; σ blocks: allowing for correlation in time"
    names = {
        "CAD": True, "truth": virtual, "identified": True, "error": virtual, "σ": True, "σ blocks": blocks, "%σ": True
    }  # fmt: skip
    for column in (name for name, there in names.items() if there):
        table.add_column(column, justify="right")
    table.add_column("unit")
    for row in rows:
        cells = [row.cad, *([row.truth] if virtual else []), row.value, *([row.error] if virtual else [])]
        deviations = [row.deviation, *([row.block_deviation] if blocks else []), row.relative_deviation]
        table.add_row(row.name, *map(_number, cells), *(_number(x, 2) for x in deviations), row.unit)
    yield table


def _bodies(found: Identified, shown: MethodResult) -> Iterator[RenderableType]:
    table = Table(title=f"\nLinks by {shown.name}", title_justify="left", caption_justify="left")
    table.caption = "beyond the base parameters the values are those of CAD, or of the method's prior"
    table.add_column("link", overflow="fold")
    for column in (
        "mass CAD\n[kg]",
        "mass\n[kg]",
        "centre of mass CAD\n[m]",
        "centre of mass\n[m]",
        "smallest pseudo-\ninertia eigenvalue",
    ):
        table.add_column(column, justify="right")
    for row in body_rows(found, shown):
        table.add_row(
            row.name,
            _number(row.cad_mass),
            _number(row.mass),
            _vector(row.cad_center),
            _vector(row.center),
            f"{row.eigenvalue:.2g}",
        )
    yield table


def _undetermined(found: Identified) -> Iterator[RenderableType]:
    comparison = found.comparison
    if comparison.lost:
        yield Text(f"\nnot determined by this recording: {_list(comparison.lost)}")
    yield Text(
        f"{len(comparison.undetermined)} of {len(comparison.names)} parameters are determined in combinations only, or "
        f"not at all{': ' + _list(comparison.undetermined) if comparison.undetermined else ''}"
    )


def _list(names: tuple[str, ...]) -> str:
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return "; ".join(names[:MOST_NAMES]) + more


def _number(x: float, digits: int = 4) -> str:
    return "–" if not np.isfinite(x) else f"{x:.{digits}g}"


def _vector(values: np.ndarray) -> str:
    return "–" if not np.all(np.isfinite(values)) else " ".join(f"{x:.3f}" for x in values)
