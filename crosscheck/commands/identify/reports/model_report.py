"""One result of an identification: its torques beside the measured ones, its parameters beside those of CAD."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from crosscheck.identifying import Identified, IdentifiedModel, TorqueCurve
from crosscheck.identifying.results.link_findings import link_findings
from crosscheck.identifying.results.parameters import BaseRow, base_rows, body_rows, correlation_of, deviations_of
from crosscheck.report.pictures.parameter_rows import put_key, put_rows, size
from crosscheck.report.pictures.svg import CURVES, FAINT_COLOR, INK, picture
from crosscheck.report.plain_text import superscript
from crosscheck.report.report import (
    NO_VALUE,
    WIDE_LINE_CHARACTERS,
    Column,
    Note,
    Notes,
    Panel,
    Picture,
    Plot,
    Row,
    Section,
    Series,
    Table,
)
from graphdyn.errors import counted
from graphdyn.identification import MethodResult
from graphdyn.layout import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes


LINEAR_AXIS_SHARE = 1e-4
"""Part of the largest torque below which the axis is linear."""

FOUND_COLOR, CAD_COLOR, TRUE_COLOR = CURVES[:3]


def parameter_bars(key: str, rows: Sequence[BaseRow], sizes: Array) -> Markup:
    """Every base parameter beside CAD, in a common unit: the torque that it makes over the recording.

    sizes: root mean square torque that a parameter of 1 makes, over all joints (r,)
    """
    label = f"{len(rows)} base parameters with error bars of two standard deviations beside the CAD values"
    return picture(key, label, size(len(rows)), lambda axes: _draw(axes, rows, sizes))


def _draw(axes: Axes, rows: Sequence[BaseRow], sizes: Array) -> None:
    found, cad, true = (sizes * np.array([getattr(row, name) for row in rows]) for name in ("value", "cad", "truth"))
    reach = float(np.nanmax(np.abs([*found, *cad]), initial=0.0)) or 1.0
    bar = np.nan_to_num(2 * sizes * [row.block_deviation for row in rows], posinf=4 * reach)
    axes.set_xscale("symlog", linthresh=LINEAR_AXIS_SHARE * reach, linscale=0.5)
    axes.set(xlim=(-2 * reach, 2 * reach))
    decades = range(int(np.ceil(np.log10(LINEAR_AXIS_SHARE * reach))), int(np.floor(np.log10(2 * reach))) + 1, 2)
    ticks = [*(-(10.0**k) for k in reversed(decades)), 0.0, *(10.0**k for k in decades)]
    names = [*(f"−{superscript(k)}" for k in reversed(decades)), "0", *map(superscript, decades)]
    axes.set_xticks(ticks, names, fontsize=9, color=INK)
    axes.set_xticks([], minor=True)
    put_rows(axes, [row.name for row in rows])
    axes.vlines(ticks, 0, len(rows), color=FAINT_COLOR, linewidth=0.5, zorder=0)
    y = np.arange(len(rows)) + 0.5
    axes.hlines(y, -2 * reach, 2 * reach, color=FAINT_COLOR, linewidth=0.4, zorder=0)
    axes.set_xlabel("torque that the parameter makes, root mean square [N m]", fontsize=9, color=INK)
    axes.plot(cad, y, linestyle="", marker="o", markersize=5, mfc="none", mec=CAD_COLOR, mew=1.1, label="CAD")
    if np.isfinite(true).any():
        axes.plot(true, y, linestyle="", marker="x", markersize=5, mec=TRUE_COLOR, mew=1.3, label="truth")
    axes.errorbar(
        found,
        y,
        xerr=bar,
        linestyle="",
        marker="o",
        markersize=3,
        color=FOUND_COLOR,
        elinewidth=1.2,
        label="identified ± 2 σ",
    )
    put_key(axes, 3)


BLUE_CURVE, RED_CURVE, GRAY_CURVE = 0, 1, 7
"""Colors of curves."""

TORQUE_HEIGHT, RESIDUAL_HEIGHT = 0.8, 0.45
"""Heights of the panels of a joint."""

VALUE_FORMAT: dict[str, Any] = {"kind": "number", "form": ".4g"}
DEVIATION_FORMAT: dict[str, Any] = {"kind": "number", "form": ".2g"}


def torques_section(found: Identified, shown: MethodResult) -> Section:
    """The section of the page with every joint over the fitted rows and, beside it, over those held out and those kept
    aside."""
    of_shown = found.model_of(shown)
    sides = {
        "fitted": of_shown.fit.curves(shown.name),
        "held out": [curve for trial in of_shown.trials for curve in trial.curves(shown.name)],
        "kept aside": [curve for trial in of_shown.aside for curve in trial.curves(shown.name)],
    }
    model = found.torque_model.model
    plots = tuple(
        _torque_plot(joint.name, j, joint.is_prismatic, side, curves)
        for j, joint in enumerate(model.joints[k] for k in model.degrees_of_freedom.independent)
        for side, curves in sides.items()
        if curves
    )
    return Section("torques", f"Torques by {of_shown.row_name(shown)}", plots)


def _torque_plot(joint: str, j: int, prismatic: bool, side: str, curves: Sequence[TorqueCurve]) -> Plot:
    """j: number of the joint, from 0."""
    torque, unit = ("force", "N") if prismatic else ("torque", "N m")
    measured, predicted = (_joined([getattr(c, name)[:, j] for c in curves]) for name in ("measured", "predicted"))
    t, restarts = _times([curve.t for curve in curves])
    residual = predicted - measured
    error = f"root mean square error {np.sqrt(np.nanmean(residual**2)):.3g} {unit}"
    return Plot(
        t,
        "t [s], recordings one after another" if restarts else "t [s]",
        (
            Panel(
                torque,
                (
                    Series("measured", measured, color=GRAY_CURVE),
                    Series("predicted", predicted, "dashed", color=BLUE_CURVE),
                ),
                unit,
                height=TORQUE_HEIGHT,
            ),
            Panel(
                "predicted minus measured",
                (Series("residual", residual, color=RED_CURVE),),
                unit,
                height=RESIDUAL_HEIGHT,
            ),
        ),
        f"Measured and predicted {torque} of {joint}; {side}: {error}",
        f"{counted(len(t) - len(curves) + 1, 'row')}, {error}",
        wide=False,
        title=f"{joint}, {side}",
    )


def _times(pieces: Sequence[Array]) -> tuple[Array, bool]:
    """Times of the pieces as _joined joins them, and whether some begin before the one in front of them ends.

    Those follow it at once, so that the times do not decrease.
    """
    parts, shift, restarts = [pieces[0]], 0.0, False
    for piece in pieces[1:]:
        end = parts[-1][-1]
        if piece[0] + shift < end:
            shift, restarts = end - piece[0], True
        parts += [np.array([end]), piece + shift]
    return np.concatenate(parts), restarts


def _joined(pieces: Sequence[Array]) -> Array:
    """The pieces (N_k,) one after another with NaN between them."""
    return np.concatenate([part for piece in pieces for part in (np.array([np.nan]), piece)][1:])


def parameters_section(found: Identified, shown: MethodResult) -> Section:
    rows = base_rows(found, shown)
    source = _source(found, shown)
    caption = (
        "Base parameters, each in the torque that it makes over the fitted rows of all joints. "
        f"Error bars: twice σ blocks. {source}."
    )
    return Section(
        "parameters",
        f"Parameters by {found.model_of(shown).row_name(shown)}",
        (
            Picture(lambda key: parameter_bars(key, rows, _torque_sizes(found.model_of(shown))), caption),
            _base_parameters(rows, source, virtual=found.truth is not None),
            _links(found, shown),
            *_link_findings(found, shown),
        ),
    )


def _base_parameters(rows: Sequence[BaseRow], source: str, *, virtual: bool) -> Table:
    """virtual: the truth is known."""
    columns = {
        "name": Column("base parameter", "name"),
        "cad": Column("CAD", **VALUE_FORMAT),
        **({"truth": Column("truth", **VALUE_FORMAT)} if virtual else {}),
        "value": Column("identified", **VALUE_FORMAT),
        **({"error": Column("error", **VALUE_FORMAT)} if virtual else {}),
        "deviation": Column("σ white", **DEVIATION_FORMAT, from_width=WIDE_LINE_CHARACTERS),
        "block_deviation": Column("σ blocks", **DEVIATION_FORMAT),
        "relative_deviation": Column("%σ blocks", **DEVIATION_FORMAT),
        "unit": Column("unit"),
        "symbol": Column("symbol", from_width=WIDE_LINE_CHARACTERS),
    }
    return Table(
        tuple(columns.values()),
        tuple(Row(tuple(getattr(row, name) for name in columns)) for row in rows),
        title="Base parameters",
        caption=f"{source}; σ white: for white noise, σ blocks: allowing for correlation in time; CAD: the robot as "
        "given, drives zero; symbol: Khalil's, with R where others are regrouped into it",
    )


def _source(found: Identified, shown: MethodResult) -> str:
    """Whose standard deviations are shown, and whether they are a lower bound."""
    result, source = deviations_of(found, shown)
    if result is None:
        return f"No σ: {source}"
    if correlation_of(found, result).lower_bound:
        return f"σ {source} (a lower bound: the recording is too short for its correlation)"
    return f"σ {source}"


def _links(found: Identified, shown: MethodResult) -> Table:
    return Table(
        (
            Column("link", "name"),
            Column("mass CAD", unit="kg", **VALUE_FORMAT),
            Column("mass", unit="kg", **VALUE_FORMAT),
            Column("center of mass CAD", "vector", "m", _position_text),
            Column("center of mass", "vector", "m", _position_text),
            Column("smallest pseudo-inertia eigenvalue", **DEVIATION_FORMAT),
        ),
        tuple(
            Row((row.name, row.cad_mass, row.mass, row.cad_center, row.center, row.eigenvalue))
            for row in body_rows(found, shown)
        ),
        title="Links",
        caption="beyond the base parameters the values are those of CAD, or of the method's prior",
    )


def _link_findings(found: Identified, shown: MethodResult) -> tuple[Notes, ...]:
    """What a limit holds, and what the recording has against CAD."""
    notes = tuple(
        Note(f"{each.message}; {each.remedy}", state="disagrees" if each.code == "cad-mass" else "undecided")
        for each in link_findings(found, shown)
    )
    return (Notes(notes, title="What the limits of the links hold"),) if notes else ()


def _position_text(position: Array) -> str:
    return " ".join(f"{x:.4f}" for x in position) if np.all(np.isfinite(position)) else NO_VALUE


def _torque_sizes(model: IdentifiedModel) -> Array:
    """Root mean square torque that each base parameter makes at 1, over the rows that count (r,)."""
    equations = model.problem.equations
    factors = equations.factors[..., :-1]
    return np.asarray(np.sqrt(np.sum(factors**2, axis=(0, 1)) / equations.counts.sum()))
