"""A change of columns as text, and as complete lines of a mapping file that correct it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from crosscheck.recordings import ColumnMapping, Recording
from crosscheck.recordings.mapping.mapping import Channel
from graphdyn.identification.data_quality import Change, RecordedColumns
from graphdyn.layout import Array


def change_in_words(change: Change, joint_names: Sequence[str], deviation: float = float("nan")) -> str:
    """The fault as text, such as "the torque of elbow is reversed". deviation: of a lag [s]."""
    names = " and ".join(joint_names[j] for j in change.joints)
    alone = {"": "", "position": " (velocity right)", "velocity": " in its velocity alone"}[change.alone]
    turned = ""
    if change.zero is not None and change.kind != "zero":
        turned = ", with its zero half a turn away"
    match change.kind:
        case "reversed torque":
            return f"the torque of {names} is reversed"
        case "reversed position":
            return f"the position of {names} is reversed{alone}{turned}"
        case "reversed joint":
            return f"{names} turns the other way than in the model, position and torque{turned}"
        case "exchanged torques":
            return f"the torques of {names} are exchanged"
        case "exchanged positions":
            return f"the positions of {names} are exchanged{alone}"
        case "exchanged joints":
            return f"{names} are exchanged, positions and torques"
        case "all torques reversed":
            return "all torques are reversed, or gravity"
        case "all positions reversed":
            return "all positions are reversed"
        case "degrees":
            return f"the positions are in degrees{alone}"
        case "radians":
            return f"the positions are in rad, and were taken for degrees{alone}"
        case "zero":
            degrees = float(np.rad2deg(change.zero[list(change.joints)][0]))  # type: ignore[index]
            return f"the zero of {names} is {-degrees:g}° away from that of the model"
        case "scaled torque":
            if len(change.joints) > 1:
                return f"all torques are {change.factor:.3g} times those of CAD and drives, as in another unit"
            return f"the torque of {names} is {change.factor:.3g} times that of the others, as in another unit"
        case "late torque":
            who = "the torques were" if len(change.joints) > 1 else f"the torque of {names} was"
            when = "late" if change.factor > 0 else "early"
            return f"{who} recorded {1e3 * abs(change.factor):.1f} ± {1e3 * deviation:.1f} ms {when}"


def recorded_columns(recording: Recording) -> RecordedColumns:
    """Conversion of the file's columns to the joints of the recording, in the order of the latter."""
    n, mapping = recording.n_joints, _mapping_of(recording)
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
    """The lines, table by table; unchanged joints keep their values."""
    mapping = _mapping_of(recording)
    to_mapping = [recording.joint_names.index(joint) for joint in mapping.joints]
    tables: dict[str, dict[str, str]] = {}
    for name, matrix in (("q", change.position), ("v", change.velocity), ("tau", change.torque)):
        if matrix is not None and name in mapping.channels:
            tables[name] = _multiplied(name, matrix[np.ix_(to_mapping, to_mapping)], change, mapping.channels[name])
    if change.zero is not None:
        degrees = np.rad2deg(mapping.channels["q"].offset + change.zero[to_mapping])
        whole = {"offset": _numbers(np.where(np.abs(degrees - 360) < 1e-9, 0.0, degrees)), "offset_unit": '"deg"'}
        tables["q"] = tables.get("q", {}) | whole
    if change.kind == "late torque":
        late = np.zeros(len(mapping.joints))
        late[[to_mapping.index(j) for j in change.joints]] = change.factor
        tables["tau"] = {"delay": _numbers(np.round(mapping.channels["tau"].delays + late, 4))}
    return tuple(
        line for name, table in tables.items() for line in (f"[{name}]", *(f"{key} = {table[key]}" for key in table))
    )


def _mapping_of(recording: Recording) -> ColumnMapping:
    """The mapping of the recording; for one from another source, that of a file with a column per joint, in order."""
    n = recording.n_joints
    one, zero = np.ones(n), np.zeros(n)
    channel = Channel(tuple(range(1, n + 1)), one, zero, (None,) * n, signs=one, delays=zero)
    columns = recording.provenance.columns
    return columns or ColumnMapping("", recording.joint_names, {"q": channel, "tau": channel})


def _multiplied(name: str, matrix: Array, change: Change, channel: Channel) -> dict[str, str]:
    """Keys and values of one table for a matrix by which its columns are to be multiplied."""
    if change.kind in ("degrees", "radians"):
        unit = {"degrees": "deg", "radians": "rad"}[change.kind]
        return {"unit": f'"{unit}"' if name == "q" else f'"{unit}/s"'}
    if change.kind == "scaled torque":
        gains = np.abs(channel.factor * np.diag(matrix))
        return {"unit": '"N m"', "sign": _numbers(np.sign(channel.factor)), "gain": _numbers(gains)}
    order = np.argmax(np.abs(matrix), axis=1)
    if np.array_equal(order, np.arange(len(matrix))):
        return {"sign": _numbers(channel.signs * np.diag(matrix))}
    return {"columns": "[" + ", ".join(_toml(channel.columns[k]) for k in order) + "]"}


def _toml(column: str | int) -> str:
    if isinstance(column, int):
        return str(column)
    return '"' + column.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _numbers(values: Array) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"
