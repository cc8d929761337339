"""Gains of the motors as a section of a report."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from crosscheck.identifying import FittedCurrents, Identified
from crosscheck.identifying.results.parameters import base_rows
from crosscheck.report.report import Column, Note, Notes, Prose, Row, Section, Table
from graphdyn.identification import MethodResult
from graphdyn.identification.currents import gain_deviations
from graphdyn.model import unit_of

SCALED_TOGETHER = (
    "the gain of {joints} is not determined: it scales together with the parameters of all links that this joint "
    "moves; know a load, the gain, or the gravity of these links, and move the joint"
)


def gains_section(found: FittedCurrents) -> Section:
    """Gain, deviation and residuals of every joint, and what is not determined."""
    unit = unit_of(found.subject.model.joints, "N m", "N")
    columns = (
        Column("joint", "name"),
        Column("gain", "number", form=".5g", meaning=f"torque [{unit}] per unit of the recorded column"),
        Column("σ", "number", form=".2g"),
        Column("σ", "number", "%", ".2g", meaning="relative"),
        *(Column(f"‖e‖/‖c‖ {name}", "number", "%", ".3g", "residual over moving rows") for name in found.names),
    )
    gains = found.gains
    rows = [
        Row(
            (
                name,
                float(gains.values[j]),
                float(gains.deviations[j]),
                float(100 * gains.relative_deviations[j]),
                *(float(100 * residual) for residual in found.relative_residuals[:, j]),
            )
        )
        for j, name in enumerate(found.joints)
    ]
    table = Table(columns, tuple(rows), caption=f"from {found.known}", failures_first=False)
    lost = [name for name, known in zip(found.joints, gains.determined, strict=True) if not known]
    said = [SCALED_TOGETHER.format(joints=", ".join(lost))] if lost else []
    notes = Notes(tuple(Note(text, state="undecided") for text in (*said, *found.warnings, *_too_short(found))))
    return Section("gains", "Gains: torque per unit of the recorded column", (table, notes))


def gains_of_identified(found: Identified, shown: MethodResult | None) -> tuple[Section, ...]:
    """The gains that have converted the currents of an identification, and what they add to the deviations."""
    if found.currents is None:
        return ()
    section = gains_section(found.currents)
    if shown is None:
        return (section,)
    rows, added = (
        base_rows(found, shown),
        gain_deviations(found.model_of(shown).problem.equations, found.currents.gains),
    )
    known = np.array([row.block_deviation for row in rows])
    table = Table(
        (
            Column("parameter", "name"),
            Column("value", "number", form=".4g"),
            Column("σ", "number", form=".2g", meaning="for these gains"),
            Column("σ of gains", "number", form=".2g", meaning="from those of the gains alone"),
            Column("both", "number", form=".2g", meaning="root of the sum of squares"),
            Column("unit"),
        ),
        tuple(
            Row((row.name, row.value, sigma, own, float(np.hypot(sigma, own)), row.unit))
            for row, sigma, own in zip(rows, known.tolist(), added.tolist(), strict=True)
        ),
        title="What the gains add to the base parameters",
        on=("page",),
        folded=True,
        failures_first=False,
    )
    ratio = float(np.nanmax(added / known, initial=0.0))
    words = (
        "Deviations of base parameters further below are for these gains; the deviations of the gains come on top, up "
        f"to {ratio:.2g} times as large. The page and the JSON file have them for every parameter."
    )
    return (replace(section, blocks=(*section.blocks, Prose(words), table)),)


def _too_short(found: FittedCurrents) -> tuple[str, ...]:
    if not found.lower_bound:
        return ()
    return (
        f"the shortest recording has {found.correlation_times:.0f} correlation times of its residual: every σ is a "
        "lower bound; record longer",
    )
