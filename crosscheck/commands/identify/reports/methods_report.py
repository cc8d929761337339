"""The methods of an identification beside each other: how each predicts, what it says, what it assumes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from crosscheck.identifying import Candidate, Identified
from crosscheck.identifying.methods.candidate_models import CAD_NAME
from crosscheck.identifying.results.recommending import joint_errors, mean_error, real
from crosscheck.report.pictures.svg import CURVES, FAINT_COLOR, INK, MIDDLE_COLOR, picture
from crosscheck.report.plain_text import superscript
from crosscheck.report.report import NO_VALUE, Column, Note, Notes, Picture, Row, Section, Table, Verdict
from graphdyn.errors import counted
from graphdyn.identification import ResidualStatistics
from graphdyn.layout import Array
from graphdyn.model import unit_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


WIDTH, ROW, AXIS = 7.6, 0.3, 0.85
"""Sizes of the picture, of one row, of axis and key [inches]."""

METHOD_MARKERS = "os^Dv*Px<>ph"
MEAN_COLOR, JOINT_COLOR = CURVES[0], MIDDLE_COLOR

SINGULAR_VALUES_HEIGHT = 2.6
"""[inches]"""


def method_errors(key: str, methods: Sequence[str], joints: Sequence[str], errors: Array) -> Markup:
    """errors: relative, methods by joints (m, n)."""
    of = f"{counted(len(methods), 'method')} for {counted(len(joints), 'joint')}"
    label = f"Held-out error of {of}, on a logarithmic axis in percent"
    height = ROW * len(methods) + AXIS
    return picture(key, label, (WIDTH, height), lambda axes: _draw(axes, methods, joints, 100 * errors, height))


def _draw(axes: Axes, methods: Sequence[str], joints: Sequence[str], errors: Array, height: float) -> None:
    axes.set_position((0.27, 0.45 / height, 0.71, ROW * len(methods) / height))
    axes.set_xscale("log")
    axes.set(ylim=(len(methods), 0), xlim=(0.8 * np.nanmin(errors), 1.25 * np.nanmax(errors)))
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.set_yticks(np.arange(len(methods)) + 0.5, methods, fontsize=9, color=INK)
    axes.tick_params(axis="y", length=0)
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    axes.xaxis.set_minor_formatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "25" else "")
    axes.tick_params(axis="x", which="both", labelsize=8.5, length=2, color=INK)
    axes.set_xlabel("‖e‖ / ‖τ‖ [%] over rows that were not fitted", fontsize=9, color=INK)
    y = np.arange(len(methods)) + 0.5
    axes.hlines(y, *axes.get_xlim(), color=FAINT_COLOR, linewidth=0.6, zorder=0)
    for j, name in enumerate(joints):
        marker = METHOD_MARKERS[j % len(METHOD_MARKERS)]
        axes.plot(
            errors[:, j], y, linestyle="", marker=marker, markersize=4.5, color=JOINT_COLOR, alpha=0.8, label=name
        )
    axes.plot(
        np.nanmean(errors, axis=1), y, linestyle="", marker="|", markersize=13, color=MEAN_COLOR, mew=2.2, label="mean"
    )
    axes.legend(
        loc="lower left", bbox_to_anchor=(-0.37, 1.0), ncols=min(len(joints) + 1, 7), fontsize=7.5, frameon=False,
        handletextpad=0.1, columnspacing=0.8,
    )  # fmt: skip


def singular_values(key: str, values: Array) -> Markup:
    """values: of the regressor with columns at unit length, falling (r,)."""
    label = f"{len(values)} singular values from {values[0]:.3g} to {values[-1]:.3g}"
    return picture(key, label, (WIDTH, SINGULAR_VALUES_HEIGHT), lambda axes: _draw_singular(axes, values))


def _draw_singular(axes: Axes, values: Array) -> None:
    axes.set_position((0.09, 0.17, 0.89, 0.78))
    axes.set_yscale("log")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8.5, length=2, color=INK)
    axes.yaxis.set_major_formatter(lambda x, _: superscript(round(np.log10(x))))
    axes.plot(np.arange(1, len(values) + 1), values, color=MEAN_COLOR, marker="o", markersize=3, linewidth=0.8)
    axes.set_xlabel("number of the singular value", fontsize=9, color=INK)


def methods_section(found: Identified) -> Section:
    answered = [candidate for candidate in found.candidates if candidate.result.failure is None]
    caption = "Held-out error per joint over its moving rows (|v| > 0.02 rad/s or m/s); over all rows for a joint that "
    pictures = [Picture(partial(_errors_drawn, found, answered), f"{caption}hardly moves.")] if answered else []
    different = {candidate.result.name: candidate.result for candidate in found.candidates}
    assumed = tuple(
        Note(f"{result.assumptions}. Needs {result.needs}. {result.reference}.", where=name)
        for name, result in different.items()
    )
    blocks = (
        _methods(found),
        Notes(tuple(_remarks(found.candidates)), title="What the methods say"),
        *pictures,
        _errors(found, "held out", {c.name: c.result.held_out for c in found.candidates}),
        *([_trial_errors(found)] if len(found.trials) > 1 else []),
        *(_errors(found, f"kept aside: {rows.name}", _aside(answered, k)) for k, rows in enumerate(found.aside)),
        _errors(found, "fitted", {c.name: c.result.training for c in found.candidates}),
        Notes(assumed, title="What each method assumes and needs", on=("page",), folded=True),
    )
    return Section("methods", "Methods", blocks)


def _aside(answered: Sequence[Candidate], k: int) -> dict[str, ResidualStatistics | None]:
    """Errors on the k-th part of the rows that were kept aside."""
    return {c.name: c.model.aside[k].statistics.get(c.result.name) for c in answered}


def _methods(found: Identified) -> Table:
    known = any(model.cad_of is not None for model in found.models)
    words_of_cad = f"; {CAD_NAME}: as in the file, drives fitted" if known else ""
    return Table(
        (
            Column("method", "name"),
            Column("verdict", "verdict"),
            Column("held-out error", "number", "%", ".2f"),
            Column("consistent links", "number", meaning="physically consistent links"),
            Column("M positive definite", "number", meaning="poses in which the mass matrix is positive definite"),
            Column("smallest eigenvalue", "number", form=".2g", meaning="of the mass matrix, over all poses"),
            Column("time", "number", "s", ".2f", meaning="of the estimation alone"),
        ),
        tuple(_method(found, candidate) for candidate in found.candidates),
        caption="error: ‖e‖/‖τ‖ over the moving rows of each joint (all rows where it hardly moves), mean over joints; "
        f"M: the mass matrix in random poses{words_of_cad}",
    )


def _method(found: Identified, candidate: Candidate) -> Row:
    result, plausible = candidate.result, candidate.result.plausibility
    if result.failure is not None or plausible is None:
        return Row((candidate.name, Verdict("disagrees", "failed"), *4 * (None,), result.seconds), "disagrees")
    verdict: Verdict | str = "" if real(result) else Verdict("disagrees", "not physically consistent")
    if candidate.name == found.recommendation.name:
        verdict = Verdict("agrees", "recommended")
    links = int((plausible.pseudo_inertia_eigenvalues >= 0).sum())
    return Row(
        (
            candidate.name,
            verdict,
            100 * mean_error(result),
            f"{links} of {found.torque_model.model.n_bodies}",
            f"{plausible.positive_definite} of {plausible.poses}",
            plausible.smallest_mass_matrix_eigenvalue,
            result.seconds,
        )
    )


def _remarks(candidates: Sequence[Candidate]) -> list[Note]:
    """Why methods failed, then what the others say of their answers."""
    failed = [
        Note(f"failed: {c.result.failure}", where=c.name, state="disagrees") for c in candidates if c.result.failure
    ]
    said = [Note(remark, where=c.name) for c in candidates if c.result.estimate for remark in c.result.estimate.remarks]
    return [*failed, *said]


def _errors(found: Identified, which: str, statistics: Mapping[str, ResidualStatistics | None]) -> Table:
    """RMS over all rows, and relative errors, per joint. statistics: by name of the candidate"""
    slow = which == "fitted" and bool(np.any(np.asarray(found.preparation.min_speed) > 0))
    unit = unit_of(found.torque_model.model.joints, "N m", "N")
    rows = []
    for name, of_rows in statistics.items():
        if of_rows is not None:
            candidate = found.candidate(name)
            relative = [
                of_rows.moving.relative,
                *([candidate.model.fitted_errors(candidate.result)] if slow else []),
            ]
            rows.append(Row((name, *zip(of_rows.everything.rms, *relative, strict=True))))
    return Table(
        (
            Column("method", "name"),
            *(Column(name, "number", form=_error_text) for name in found.torque_model.model.independent_joints),
        ),
        tuple(rows),
        title=f"Errors, {which}",
        caption=f"RMS of all rows [{unit}] / % of moving rows{' / % of fitted rows' if slow else ''}",
    )


def _error_text(errors: Sequence[float]) -> str:
    """A root mean square, then relative errors as percentages."""
    rms, *relative = errors
    return " / ".join([f"{rms:.3g}", *(NO_VALUE if np.isnan(x) else f"{100 * x:.1f}" for x in relative)])


def _trial_errors(found: Identified) -> Table:
    """The mean error of every trial."""
    rows = []
    for candidate in found.candidates:
        if candidate.result.failure is None:
            parts = [trial.statistics[candidate.result.name] for trial in candidate.model.trials]
            rows.append(Row((candidate.name, *(100 * float(np.nanmean(joint_errors(part))) for part in parts))))
    columns = (Column(trial.name, "number", form=".1f") for trial in found.trials)
    return Table(
        (Column("method", "name"), *columns),
        tuple(rows),
        title="Errors, held out, one by one",
        caption="% of moving rows, mean over joints",
        compact=True,
    )


def _errors_drawn(found: Identified, answered: Sequence[Candidate], key: str) -> Markup:
    chosen: list[Any] = [candidate.result.held_out or candidate.result.training for candidate in answered]
    errors = np.array([joint_errors(statistics) for statistics in chosen])
    return method_errors(
        key, [candidate.name for candidate in answered], found.torque_model.model.independent_joints, errors
    )
