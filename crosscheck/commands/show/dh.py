"""`graphdyn show --dh`: a table of Denavit-Hartenberg parameters, as a section and as a record."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from crosscheck.commands.show.state import rpy_in_degrees
from crosscheck.report.plain_text import vector_text
from crosscheck.report.records.record import Index, Record, attribute, written
from crosscheck.report.report import Column, Facts, Note, Notes, Row, Section, Table
from graphdyn import Placement
from urdf import DHRow, DHTable

OF_HAYATI = " Rot_y(β)"

DH_PRODUCTS = {
    "standard": f"Rot_z(θ) Tra_z(d) Tra_x(a) Rot_x(α){OF_HAYATI}",
    "modified": f"Rot_x(α) Tra_x(a){OF_HAYATI} Rot_z(θ) Tra_z(d)",
}
"""The transform of a row; Rot_y(β) only where some axes are nearly parallel."""


class ShownDHRowRecord(Record, of=DHRow, only=("name", "kind", "theta", "d", "a", "alpha", "beta")):
    """A row; the joint adds its position to θ, or to d where it slides.

    number: 1 … n
    name: of the joint
    kind: of the joint
    theta, alpha, beta: at q = 0 [rad]
    d, a: at q = 0 [m]
    """

    number: Index


class ShownDHRecord(Record, of=DHTable, only=("convention", "choices")):
    """Denavit-Hartenberg parameters.

    convention: which of the two products
    choices: what could as well be otherwise, in words
    base_xyz: origin of the first frame in the base link (3,) [m]
    base_rpy: roll, pitch, yaw of the same, R = R_z(yaw) R_y(pitch) R_x(roll) [degree]
    tool: name of the tool's frame
    tool_xyz: its origin in the frame of the last row (3,) [m]
    tool_rpy: roll, pitch, yaw of the same [degree]
    rows: one a joint
    """

    base_xyz = attribute("base.translation")
    base_rpy: Sequence[float]
    tool = attribute("tool_name")
    tool_xyz = attribute("tool.translation")
    tool_rpy: Sequence[float]
    rows: Sequence[ShownDHRowRecord]


def dh_record(table: DHTable) -> dict[str, Any]:
    return written(
        ShownDHRecord,
        table,
        base_rpy=rpy_in_degrees(table.base),
        tool_rpy=rpy_in_degrees(table.tool),
        rows=[written(ShownDHRowRecord, row, number=number) for number, row in enumerate(table.rows, start=1)],
    )


def dh_section(table: DHTable) -> Section:
    hayati = any(row.beta for row in table.rows)
    product = DH_PRODUCTS[table.convention]
    product = product if hayati else product.replace(OF_HAYATI, "")
    number: dict[str, Any] = {"kind": "number", "form": ".7g"}
    columns = (
        Column("no.", "number"),
        Column("joint", "name"),
        Column("θ", unit="°", **number),
        Column("d", unit="m", **number),
        Column("a", unit="m", **number),
        Column("α", unit="°", **number),
        *((Column("β", unit="°", **number),) if hayati else ()),
    )
    rows = [
        Row((number, row.name, *map(_shown, _numbers(row, hayati)))) for number, row in enumerate(table.rows, start=1)
    ]
    slides = any(row.kind == "prismatic" for row in table.rows)
    caption = f"{product}; joints add their position to θ{', slides to d' if slides else ''}"
    places = ((f"base, in '{table.base_name}'", table.base), (f"tool '{table.tool_name}'", table.tool))
    return Section(
        "dh",
        f"Denavit-Hartenberg parameters, {table.convention}",
        (
            Table(columns, tuple(rows), caption=caption, failures_first=False),
            Facts(tuple((name, _placed(placement)) for name, placement in places)),
            Notes(tuple(Note(choice) for choice in table.choices)),
        ),
    )


def _numbers(row: DHRow, hayati: bool) -> list[float]:
    theta, alpha, beta = (float(np.rad2deg(x)) for x in (row.theta, row.alpha, row.beta))
    return [theta, row.d, row.a, alpha, *([beta] if hayati else [])]


DH_SHOWN_ZERO = 1e-9
"""Degrees and meters below are shown as zero; the JSON and `graphdyn export --to dh` have all digits."""


def _shown(x: float) -> float:
    return 0.0 if abs(x) < DH_SHOWN_ZERO else x


def _placed(placement: Placement) -> str:
    xyz, rpy = (np.array([*map(_shown, x)]) for x in (placement.translation, rpy_in_degrees(placement)))
    return f"xyz {vector_text(xyz)} m, rpy {vector_text(rpy)}°"
