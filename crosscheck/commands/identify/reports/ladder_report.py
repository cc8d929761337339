"""How the terms of the drives were chosen, and what the residuals still hold."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.identifying import Identified
from crosscheck.identifying.choosing.ladder import Ladder, LadderStep
from crosscheck.identifying.choosing.residual_causes import ResidualCause
from crosscheck.report.report import NO_VALUE, Code, Column, Facts, Prose, Row, Section, Table
from graphdyn.identification import MIN_CORRELATION_TIMES, MethodResult

CHOSEN_MODEL_NOTE = "The chosen terms, as a file for --models"


def ladder_section(found: Identified) -> tuple[Section, ...]:
    """Every change that was tried; nothing where the terms were given."""
    ladder = found.ladder
    if ladder is None:
        return ()
    if ladder.reason:
        standard = f"Terms of the drives are the standard ones ({ladder.model.words}), not chosen: {ladder.reason}."
        return (Section("ladder", "Terms of the drives", (Prose(standard),)),)
    model = Code(f"[chosen]\nterms = [{', '.join(ladder.terms)}]", title=CHOSEN_MODEL_NOTE)
    return (Section("ladder", "Terms of the drives", (_summary(ladder, found.fit.n_rows), _steps(ladder), model)),)


def _summary(ladder: Ladder, fitted_rows: int) -> Facts:
    part = f" of the first {ladder.of_rows}" if ladder.of_rows < fitted_rows else ""
    bought = [f"{step.change} {100 * -step.difference:.2f} ± {100 * step.deviation:.2f} %" for step in ladder.taken]
    items = [
        ("chosen", ladder.model.words),
        (
            "held out",
            f"{100 * ladder.error:.2f} %, {100 * ladder.start_error:.2f} % with viscous and Coulomb friction alone; "
            f"{ladder.folds} folds of {ladder.rows} rows{part}, robust fits",
        ),
        ("steps", ", ".join(bought) or "none: no change predicts better by more than its deviation"),
    ]
    if ladder.offsets is not None:
        items.append(("offsets", _both(ladder.offsets, ladder.error, kept=bool(ladder.model.offsets))))
    if ladder.correlation_times < MIN_CORRELATION_TIMES:
        items.append(("errors of folds", _lower_bound(ladder.correlation_times)))
    return Facts(tuple(items))


def _lower_bound(correlation_times: float) -> str:
    """That errors of the folds of a short recording are a lower bound."""
    return (
        f"a lower bound of those on other runs: the rows are {correlation_times:.0f} correlation times long, fewer "
        f"than {MIN_CORRELATION_TIMES}"
    )


def _both(step: LadderStep, error: float, *, kept: bool) -> str:
    """Errors with and without offsets."""
    with_them, without = (error, step.error) if kept else (step.error, error)
    return (
        f"{'kept' if kept else 'left out'}: {100 * with_them:.2f} % with, {100 * without:.2f} % without, a difference "
        f"of {100 * (with_them - without):+.2f} ± {100 * step.deviation:.2f} %"
    )


def _steps(ladder: Ladder) -> Table:
    """One row per change, one column per rung."""
    rungs = sorted({step.rung for step in ladder.steps})
    changes = list(dict.fromkeys(step.change for step in ladder.steps))
    cells = {(step.change, step.rung): step for step in ladder.steps}
    taken = {step.rung: step for step in ladder.taken}
    errors = {1: ladder.start_error} | {rung + 1: step.error for rung, step in taken.items()}
    names = {1: "at first"} | {rung + 1: f"then {step.change}" for rung, step in taken.items()}
    whole = Row(("held-out error", *(f"{100 * errors[rung]:.2f}" for rung in rungs)))
    rows = [
        Row((change, *(_step_text(cells.get((change, rung))) for rung in rungs)), rule=not k)
        for k, change in enumerate(changes)
    ]
    return Table(
        (Column("change", "name"), *(Column(names[rung], "number", "%") for rung in rungs)),
        (whole, *rows),
        caption="what each change of the model above it adds to its held-out error, mean over the joints, and the "
        "standard deviation of this difference over the folds; ✓: taken. A change is taken if the error falls by more "
        "than the deviation, one that leaves a part out if it does not rise by more",
        failures_first=False,
    )


def _step_text(step: LadderStep | None) -> str:
    if step is None:
        return NO_VALUE
    return f"{100 * step.difference:+.2f} ± {100 * step.deviation:.2f}{' ✓' if step.taken else ''}"


def residual_section(found: Identified, shown: MethodResult) -> tuple[Section, ...]:
    """Share of the residual of every joint that each cause would explain; nothing for a short recording."""
    causes = found.residual_causes(shown)
    if not causes:
        return ()
    joints = found.torque_model.model.independent_joints
    rows = [Row((joint, *(_share_text(cause, j) for cause in causes))) for j, joint in enumerate(joints)]
    columns = (Column(cause.name, "number", "%", meaning=f"modeled by {cause.remedy}") for cause in causes)
    table = Table(
        (Column("joint", "name"), *columns),
        tuple(rows),
        caption=f"part of the squared residual of {found.model_of(shown).row_name(shown)} that each cause predicts in "
        f"folds it was not fitted to; {NO_VALUE}: no more than chance. {_remedies(causes)}",
    )
    return (Section("residuals", "What the residuals still hold", (table,)),)


def _share_text(cause: ResidualCause, joint: int) -> str:
    if not cause.shown[joint]:
        return NO_VALUE
    return f"{100 * cause.shares[joint]:.0f} ± {100 * cause.deviations[joint]:.0f}"


def _remedies(causes: Sequence[ResidualCause]) -> str:
    """Terms that would model what was found."""
    said = [f"{cause.name}: {cause.remedy}" for cause in causes if np.any(cause.shown)]
    return f"Terms: {'; '.join(said)}" if said else ""
