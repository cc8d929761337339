"""`graphdyn identify`: what a recording determines, how each method predicts, which model to use, as a report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from crosscheck.identifying import Candidate, Identified, IdentifiedModel
from crosscheck.identifying.candidate_models import CAD
from crosscheck.identifying.parameters import correlation_of, deviations_of
from crosscheck.identifying.recommending import real
from crosscheck.identifying.result_errors import joint_errors, mean_error
from crosscheck.report.commands.identified_health import doubts_sections, excitation_table, health_section
from crosscheck.report.commands.identified_model import parameters_section, torques_section
from crosscheck.report.pictures.method_errors import method_errors, singular_values
from crosscheck.report.records.identify import record
from crosscheck.report.report import (
    NOTHING,
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
from graphdyn.identification import MethodResult, ResidualStatistics
from graphdyn.identification.comparison import ENOUGH
from graphdyn.layout import Array

MOST_NAMES = 6
"""Parameters that a terminal names of a long list; the page and --json have all."""


def identify_report(found: Identified, shown: MethodResult | None) -> Report:
    """shown: the result whose torques and parameters are shown; None where no method has an answer."""
    chosen = found.recommendation
    last_line = f"use {chosen.name}: it is {chosen.reason}" if chosen.name else f"no usable model: {chosen.reason}"
    model = (torques_section(found, shown), parameters_section(found, shown)) if shown is not None else ()
    return Report(
        f"{Path(found.subject.name).name} identified",
        _verdict(found),
        (
            Section("recording", "", (_overview(found, shown),)),
            *doubts_sections(found),
            health_section(found),
            Section("methods", "Methods", _methods_blocks(found)),
            *model,
            Section("excitation", "What the motion excites", _excitation(_model(found, shown))),
            Section("end", "", (Prose(last_line, apart=True, on=("text",)),)),
        ),
        record=partial(record, found, shown),
    )


def _model(found: Identified, shown: MethodResult | None) -> IdentifiedModel:
    """The torque model of the result that is shown."""
    return found if shown is None else found.model_of(shown)


def _verdict(found: Identified) -> Verdict:
    chosen = found.recommendation
    if chosen.name is None:
        reason = chosen.reason.removesuffix(f": {'; '.join(chosen.doubts)}") if chosen.doubts else chosen.reason
        return Verdict("disagrees", "no usable model", f"{reason[0].upper()}{reason[1:]}.")
    return Verdict("agrees", f"use {chosen.name}", f"It is {chosen.reason}.")


def _overview(found: Identified, shown: MethodResult | None) -> Facts:
    comparison, fit = _model(found, shown).comparison, found.division.fit.provenance
    held_out_rows = sum(trial.n_rows for trial in found.trials)
    of_model = f" of {_model(found, shown).name}" if _model(found, shown).name else ""
    return Facts(
        (
            ("fitted", f"{found.fit.n_rows} rows of {', '.join(fit.files)}"),
            ("held out", f"{found.division.words}, {held_out_rows} rows"),
            *(("" if k else "prepared", step) for k, step in enumerate(fit.steps)),
            (
                f"parameters{of_model}",
                f"{len(comparison.names)}, of which {comparison.rank} base parameters are determined; any motion could "
                f"determine {comparison.structural_rank}",
            ),
            (
                "condition number",
                f"{comparison.condition_number:.3g}, joints weighted by their torque, columns at unit length",
            ),
            *_settings(_model(found, shown)),
            *_without_effect(_model(found, shown)),
            *_correlation(found, shown),
            ("exogeneity", _model(found, shown).exogeneity),
        )
    )


def _without_effect(model: IdentifiedModel) -> tuple[tuple[str, str], ...]:
    """Expected values that change nothing."""
    names = ", ".join(model.problem.without_effect)
    return (("no effect", f"expected values of {names}: the recording shows them in sums alone"),) if names else ()


def _settings(model: IdentifiedModel) -> tuple[tuple[str, str], ...]:
    """Of the terms, where they were found: per joint, in brackets where the recording does not say."""
    return tuple(
        (
            setting.name,
            " ".join(
                f"({value:.2g})" if end else f"{value:.2g}"
                for value, end in zip(setting.values, setting.at_end, strict=True)
            )
            + ", fitted per joint; in brackets at the end of its range",
        )
        for setting in model.settings
    )


def _correlation(found: Identified, shown: MethodResult | None) -> tuple[tuple[str, str], ...]:
    """What the residual says about the standard deviations that are shown."""
    result = None if shown is None else deviations_of(found, shown)[0]
    if result is None:
        return ()
    correlation = correlation_of(found, result)
    if not correlation.time > 0:
        return (("residuals", f"of {result.name} white"),)
    words = (
        f"of {result.name} correlated over {correlation.time:.2g} s at {correlation.joint}; the fitted rows are "
        f"{correlation.times:.0f} times as long"
    )
    if correlation.lower_bound:
        words += f", fewer than {ENOUGH}: σ is a lower bound"
    return (("residuals", words),)


def _methods_blocks(found: Identified) -> tuple[Block, ...]:
    answered = [candidate for candidate in found.candidates if candidate.result.failure is None]
    caption = "Held-out error per joint over its moving rows (|v| > 0.02 rad/s or m/s); over all rows for a joint that "
    pictures = [Picture(partial(_errors_drawn, found, answered), f"{caption}hardly moves.")] if answered else []
    different = {candidate.result.name: candidate.result for candidate in found.candidates}
    assumed = tuple(
        Note(f"{result.assumptions}. Needs {result.needs}. {result.reference}.", where=name)
        for name, result in different.items()
    )
    return (
        _methods(found),
        Notes(tuple(_remarks(found.candidates)), title="What the methods say"),
        *pictures,
        _errors(found, "held out", {c.name: c.result.held_out for c in found.candidates}),
        *([trial_errors(found)] if len(found.trials) > 1 else []),
        *(_errors(found, f"kept aside: {rows.name}", _aside(answered, k)) for k, rows in enumerate(found.aside)),
        _errors(found, "fitted", {c.name: c.result.training for c in found.candidates}),
        Notes(assumed, title="What each method assumes and needs", on=("page",), folded=True),
    )


def _aside(answered: Sequence[Candidate], k: int) -> dict[str, ResidualStatistics | None]:
    """Errors on the k-th part of the rows that were kept aside."""
    return {c.name: c.model.aside[k].statistics.get(c.result.name) for c in answered}


def _methods(found: Identified) -> Table:
    return Table(
        (
            Column("method", "name"),
            Column("verdict", "verdict"),
            Column("held-out error", "number", "%", ".2f"),
            Column("links real", "number", meaning="links that a real body can be"),
            Column("M positive definite", "number", meaning="poses in which the mass matrix is positive definite"),
            Column("smallest eigenvalue", "number", form=".2g", meaning="of the mass matrix, over all poses"),
            Column("time", "number", "s", ".2f", meaning="of the estimation alone"),
        ),
        tuple(_method(found, candidate) for candidate in found.candidates),
        caption="error: ‖e‖/‖τ‖ over the moving rows of each joint (all rows where it hardly moves), mean over joints; "
        f"M: the mass matrix in random poses{_words_of_cad(found)}",
    )


def _words_of_cad(found: Identified) -> str:
    known = any(model.cad_of is not None for model in found.models)
    return f"; {CAD}: as in the file, drives fitted" if known else ""


def _method(found: Identified, candidate: Candidate) -> Row:
    result, plausible = candidate.result, candidate.result.plausibility
    if result.failure is not None or plausible is None:
        return Row((candidate.name, Verdict("disagrees", "failed"), *4 * (None,), result.seconds), "disagrees")
    verdict: Verdict | str = "" if real(result) else Verdict("disagrees", "no real robot")
    if candidate.name == found.recommendation.name:
        verdict = Verdict("agrees", "recommended")
    links = int((plausible.pseudo_inertia_eigenvalues >= 0).sum())
    return Row(
        (
            candidate.name,
            verdict,
            100 * mean_error(result),
            f"{links} of {found.torque_model.model.n_bodies}",
            f"{plausible.positive_definite} of {len(plausible.mass_matrix_eigenvalues)}",
            plausible.mass_matrix_eigenvalues.min(),
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
    unit = "N m or N" if any(joint.is_prismatic for joint in found.torque_model.model.joints) else "N m"
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
    return " / ".join([f"{rms:.3g}", *(NOTHING if np.isnan(x) else f"{100 * x:.1f}" for x in relative)])


def trial_errors(found: Identified) -> Table:
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


def _excitation(model: IdentifiedModel) -> tuple[Block, ...]:
    comparison = model.comparison
    caption = (
        "Singular values of the regressor, joints weighted by their torque, columns at unit length: a small one is a "
        f"combination that the noise hides. Smallest accepted pivot {comparison.gap[0]:.2g}, largest rejected one "
        f"{comparison.gap[1]:.2g}, relative to the first."
    )
    shared = (
        f"{len(comparison.undetermined)} of {len(comparison.names)} parameters are determined in combinations only, or "
        "not at all"
    )
    return (
        excitation_table(model),
        Picture(lambda key: singular_values(key, _singular_values(model)), caption),
        *_listed("Not determined by this recording", comparison.lost, folded=False),
        *_listed(shared, comparison.undetermined, folded=True),
    )


def _listed(title: str, names: Sequence[str], *, folded: bool) -> tuple[Block, ...]:
    """A list of parameters: its beginning on the terminal, all of it on the page."""
    if not names:
        return ()
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return (
        Prose(f"{title}: {'; '.join(names[:MOST_NAMES])}{more}", on=("text",)),
        Prose("; ".join(names), title=title, on=("page",), folded=folded),
    )


def _errors_drawn(found: Identified, answered: Sequence[Candidate], key: str) -> Markup:
    chosen: list[Any] = [candidate.result.held_out or candidate.result.training for candidate in answered]
    errors = np.array([joint_errors(statistics) for statistics in chosen])
    return method_errors(
        key, [candidate.name for candidate in answered], found.torque_model.model.independent_joints, errors
    )


def _singular_values(model: IdentifiedModel) -> Array:
    """Of the regressor of the base parameters, joints weighted by their torque, columns at unit length (r,)."""
    equations = model.problem.equations
    size = np.sqrt(equations.measured_squares / np.maximum(equations.counts, 1))
    r, _ = equations.weighted(np.where(size > 0, size, 1.0))
    return np.asarray(np.linalg.svd(r / np.linalg.norm(r, axis=0), compute_uv=False))
