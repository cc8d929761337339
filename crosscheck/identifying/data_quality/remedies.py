"""A change of columns as lines of a mapping file, complete, to be pasted over those that are there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.recordings import ColumnMapping, Recording
from graphdyn.identification.data_quality import Change, RecordedColumns
from graphdyn.layout import Array


def recorded_columns(recording: Recording) -> RecordedColumns:
    """How the columns of its file became the joints of the recording, in the order of the latter."""
    n, mapping = recording.n_joints, recording.provenance.columns
    if mapping is None:
        return RecordedColumns.of_joints(n)
    order = [mapping.joints.index(joint) for joint in recording.joint_names]
    position: Array = np.eye(n)
    torque: Array = np.eye(n)
    both = np.ix_(order, order)
    if mapping.transmission is not None:
        if mapping.channels["q"].motor:
            position = np.asarray(np.linalg.inv(mapping.transmission.matrix), dtype=float)
        if "tau" in mapping.channels and mapping.channels["tau"].motor:
            torque = mapping.transmission.torque_matrix
    return RecordedColumns(position[both], torque[both], mapping.channels["q"].offset[order])


def mapping_lines(change: Change, recording: Recording) -> tuple[str, ...]:
    """The lines, table by table; those of joints that do not change have the values that they have."""
    mapping = recording.provenance.columns
    joints = recording.joint_names if mapping is None else mapping.joints
    to_mapping = [recording.joint_names.index(joint) for joint in joints]
    tables: dict[str, dict[str, str]] = {}
    for name, matrix in (("q", change.position), ("v", change.velocity), ("tau", change.torque)):
        if matrix is None or (mapping is not None and name not in mapping.channels):
            continue
        if mapping is None and name == "v":
            continue
        tables[name] = _multiplied(name, matrix[np.ix_(to_mapping, to_mapping)], change, mapping)
    if change.zero is not None:
        before = np.zeros(len(joints)) if mapping is None else mapping.channels["q"].offset
        degrees = np.rad2deg(before + change.zero[to_mapping])
        whole = {"offset": _numbers(np.where(np.abs(degrees - 360) < 1e-9, 0.0, degrees)), "offset_unit": '"deg"'}
        tables["q"] = tables.get("q", {}) | whole
    if change.kind == "late torque":
        before = np.zeros(len(joints)) if mapping is None else mapping.channels["tau"].delays
        late = np.zeros(len(joints))
        late[[to_mapping.index(j) for j in change.joints]] = change.factor
        tables["tau"] = {"delay": _numbers(np.round(before + late, 4))}
    return tuple(
        line for name, table in tables.items() for line in (f"[{name}]", *(f"{key} = {table[key]}" for key in table))
    )


def _multiplied(name: str, matrix: Array, change: Change, mapping: ColumnMapping | None) -> dict[str, str]:
    """Keys and values of one table for a matrix by which its columns are to be multiplied."""
    if change.kind in ("degrees", "radians"):
        unit = {"degrees": "deg", "radians": "rad"}[change.kind]
        return {"unit": f'"{unit}"' if name == "q" else f'"{unit}/s"'}
    n = len(matrix)
    signs = np.ones(n) if mapping is None else mapping.channels[name].signs
    if change.kind == "scaled torque":
        factors = np.ones(n) if mapping is None else mapping.channels[name].factor
        return {
            "unit": '"N m"',
            "sign": _numbers(np.sign(factors)),
            "gain": _numbers(np.abs(factors * np.diag(matrix))),
        }
    order = np.argmax(np.abs(matrix), axis=1)
    if np.array_equal(order, np.arange(n)):
        return {"sign": _numbers(signs * np.diag(matrix))}
    columns: Sequence[str | int] = range(1, n + 1) if mapping is None else mapping.channels[name].columns
    return {"columns": "[" + ", ".join(_toml(columns[k]) for k in order) + "]"}


def _toml(column: str | int) -> str:
    if isinstance(column, int):
        return str(column)
    return '"' + column.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _numbers(values: Array) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"
