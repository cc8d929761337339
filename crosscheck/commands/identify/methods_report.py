"""The methods of an identification beside each other: how each predicts, what it says, what it assumes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
from markupsafe import Markup

from crosscheck.commands.identify.method_errors import method_errors
from crosscheck.identifying import Candidate, Identified
from crosscheck.identifying.methods.candidate_models import CAD_NAME
from crosscheck.identifying.results.recommending import joint_errors, mean_error, real
from crosscheck.report.report import NO_VALUE, Column, Note, Notes, Picture, Row, Section, Table, Verdict
from graphdyn.identification import ResidualStatistics


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
        f"M: the mass matrix in random poses{_words_of_cad(found)}",
    )


def _words_of_cad(found: Identified) -> str:
    known = any(model.cad_of is not None for model in found.models)
    return f"; {CAD_NAME}: as in the file, drives fitted" if known else ""


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
