"""`graphdyn identify`: what a recording determines, how each method predicts, which model to use, as a report."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from crosscheck.commands.identify.record import record
from crosscheck.commands.identify.reports.gains_report import gains_of_identified
from crosscheck.commands.identify.reports.ladder_report import ladder_section, residual_section
from crosscheck.commands.identify.reports.methods_report import methods_section, singular_values
from crosscheck.commands.identify.reports.model_report import parameters_section, torques_section
from crosscheck.commands.identify.reports.quality_report import (
    data_quality_section,
    excitation_table,
    rejection_sections,
)
from crosscheck.identifying import Identified, IdentifiedModel
from crosscheck.identifying.results.parameters import correlation_of, deviations_of
from crosscheck.report.report import Block, Facts, Picture, Prose, Report, Section, Verdict
from graphdyn.errors import counted
from graphdyn.identification import MIN_CORRELATION_TIMES, MethodComparison, MethodResult
from graphdyn.layout import Array

MAX_PARAMETER_NAMES = 6
"""Parameters that a terminal names of a long list; the page and --json have all."""


def identify_report(found: Identified, shown: MethodResult | None) -> Report:
    """shown: the result whose torques and parameters are shown; None where no method has an answer."""
    chosen = found.recommendation
    recommended = f"recommended method: {chosen.name}; it is {chosen.reason}"
    last_line = recommended if chosen.name else f"no usable model: {_without_reasons(found)}"
    model: tuple[Section, ...] = ()
    if shown is not None:
        model = (torques_section(found, shown), *residual_section(found, shown), parameters_section(found, shown))
    return Report(
        f"{Path(found.subject.name).name} identified",
        _verdict(found),
        (
            Section("recording", "", (_overview(found, shown),)),
            *gains_of_identified(found, shown),
            *rejection_sections(found),
            data_quality_section(found),
            *ladder_section(found),
            methods_section(found),
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
        reason = _without_reasons(found)
        return Verdict(
            "disagrees", "no usable model", f"{reason[0].upper()}{reason[1:]}.", "No method gives a usable model."
        )
    return Verdict(
        "agrees",
        f"recommended method: {chosen.name}",
        f"It is {chosen.reason}.",
        f"The model of the method “{chosen.name}” is recommended.",
    )


def _without_reasons(found: Identified) -> str:
    """Why no method is recommended, without the reasons of each joint, which have a section of their own."""
    chosen = found.recommendation
    listed = f": {'; '.join(chosen.rejection_reasons)}"
    return chosen.reason.removesuffix(listed) if chosen.rejection_reasons else chosen.reason


def _overview(found: Identified, shown: MethodResult | None) -> Facts:
    comparison, fit = _model(found, shown).comparison, found.division.fit.provenance
    held_out_rows = sum(trial.n_rows for trial in found.trials)
    of_model = f" of {_model(found, shown).name}" if _model(found, shown).name else ""
    return Facts(
        (
            ("fitted", f"{counted(found.fit.n_rows, 'row')} of {', '.join(fit.files)}"),
            ("held out", f"{found.division.words}, {counted(held_out_rows, 'row')}"),
            *_gravity(found),
            *(("" if k else "prepared", step) for k, step in enumerate(fit.steps)),
            (
                f"parameters{of_model}",
                f"{len(comparison.names)}; {comparison.structural_rank} combinations are identifiable, and this motion "
                f"determines {'all ' if comparison.rank == comparison.structural_rank else ''}{comparison.rank}",
            ),
            *_nearly_undetermined(comparison),
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


def _gravity(found: Identified) -> tuple[tuple[str, str], ...]:
    """Gravity, if it was found from the recordings."""
    if found.gravity is None:
        return ()
    vector = " ".join(f"{g:.4g}" for g in found.gravity.gravity)
    before, after = (100 * np.exp(np.mean(np.log(errors))) for errors in (found.gravity.before, found.gravity.after))
    words = f"{vector} m/s² in world axes, direction ± {found.gravity.deviation:.2g}°, found from the recordings"
    return (("gravity", f"{words}: the equations fit with {after:.3g} % instead of {before:.3g} %"),)


def _nearly_undetermined(comparison: MethodComparison) -> tuple[tuple[str, str], ...]:
    names = ", ".join(comparison.nearly_undetermined)
    why = "only the rounding of angles in the robot's file shows them; --angles-as-written keeps them"
    return (("nearly undetermined", f"{names}: {why}"),) if names else ()


def _without_effect(model: IdentifiedModel) -> tuple[tuple[str, str], ...]:
    """Expected values that change nothing."""
    names = ", ".join(model.problem.without_effect)
    return (("no effect", f"expected values of {names}: the recording shows them in sums alone"),) if names else ()


def _settings(model: IdentifiedModel) -> tuple[tuple[str, str], ...]:
    """Settings of the terms, where they were found: per joint, in brackets where the recording does not say."""
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
        words += f", fewer than {MIN_CORRELATION_TIMES}: σ is a lower bound"
        if any(trial.fold is not None for trial in found.division.trials):
            words += ", and errors of folds are one of those on other runs"
    return (("residuals", words),)


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
    more = f" and {len(names) - MAX_PARAMETER_NAMES} more" if len(names) > MAX_PARAMETER_NAMES else ""
    return (
        Prose(f"{title}: {'; '.join(names[:MAX_PARAMETER_NAMES])}{more}", on=("text",)),
        Prose("; ".join(names), title=title, on=("page",), folded=folded),
    )


def _singular_values(model: IdentifiedModel) -> Array:
    """Singular values of the regressor of the base parameters, joints weighted by their torque, columns at unit length
    (r,)."""
    equations = model.problem.equations
    size = np.sqrt(equations.measured_squares / np.maximum(equations.counts, 1))
    r, _ = equations.weighted(np.where(size > 0, size, 1.0))
    return np.asarray(np.linalg.svd(r / np.linalg.norm(r, axis=0), compute_uv=False))
