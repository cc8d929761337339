"""Gains of the motors as a section of a report."""

from __future__ import annotations

from crosscheck.identifying import FittedCurrents
from crosscheck.report.report import Column, Note, Notes, Row, Section, Table

SCALED_TOGETHER = (
    "the gain of {joints} is not determined: it scales together with the parameters of all links that this joint "
    "moves; know a load, the gain, or the gravity of these links, and move the joint"
)


def gains_section(found: FittedCurrents) -> Section:
    """Gain, deviation and residuals of every joint, and what is not determined."""
    columns = (
        Column("joint", "name"),
        Column("gain", "number", form=".5g", meaning="torque [N m or N] per unit of the recorded column"),
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
    notes = [Note(SCALED_TOGETHER.format(joints=", ".join(lost)), state="undecided")] if lost else []
    return Section("gains", "Gains: torque per unit of the recorded column", (table, Notes(tuple(notes))))
