"""Lines of a mapping file that correct changes of columns, one change after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings import ColumnMapping, Recording
from crosscheck.recordings.mapping.mapping import MAPPED_QUANTITIES, Channel, Transmission
from crosscheck.recordings.mapping.units import SLIDING_UNITS, TURNING_UNITS
from graphdyn.identification.data_quality import Change, RecordedColumns
from graphdyn.layout import Array

FACTOR_TOLERANCE = 1e-9
"""Largest relative difference between a factor and that of its unit: rounding."""


def recorded_columns(recording: Recording) -> RecordedColumns:
    """Conversion of the file's columns to the joints of the recording, in the order of the latter."""
    mapping = _mapping_of(recording)
    order = [mapping.joints.index(joint) for joint in recording.joint_names]
    both = np.ix_(order, order)
    channels = mapping.channels
    return RecordedColumns(
        _to_joints(mapping, "q")[both],
        _to_joints(mapping, "tau")[both],
        channels["q"].offset[order],
        channels["q"].factor[order],
        channels["tau"].factor[order] if "tau" in channels else None,
    )


def mapping_lines(changes: Sequence[Change], recording: Recording) -> list[tuple[str, ...]]:
    """The lines that correct each change, table by table, if those before it are in the mapping already.

    Each line replaces the key of its table; unchanged joints keep their values. A change that no key can express, such
    as an angle in a unit without a name, has no lines.
    """
    original = _mapping_of(recording)
    lines, now = [], original
    for change in changes:
        corrected = _corrected(now, change, original, recording.joint_names)
        lines.append(_lines(now, corrected))
        now = corrected
    return lines


def _mapping_of(recording: Recording) -> ColumnMapping:
    """The mapping of the recording; for one from another source, that of a file with a column per joint, in order."""
    n = recording.n_joints
    one, zero = np.ones(n), np.zeros(n)
    channel = Channel(tuple(range(1, n + 1)), one, zero, (None,) * n, signs=one, delays=zero)
    columns = recording.provenance.columns
    return columns or ColumnMapping("", recording.joint_names, {"q": channel, "tau": channel})


def _to_joints(mapping: ColumnMapping, name: str) -> Array:
    """Matrix from the columns of a quantity, in SI units, to its joint coordinates (n, n)."""
    channel = mapping.channels.get(name)
    if mapping.transmission is None or channel is None or not channel.motor:
        return np.eye(len(mapping.joints))
    if name == "tau":
        return mapping.transmission.torque_matrix
    return np.asarray(np.linalg.inv(mapping.transmission.matrix), dtype=float)


def _corrected(
    mapping: ColumnMapping, change: Change, original: ColumnMapping, joint_names: Sequence[str]
) -> ColumnMapping:
    """The mapping after the change of its columns. original: the mapping with which the recording was read"""
    to_mapping = [joint_names.index(joint) for joint in mapping.joints]
    both = np.ix_(to_mapping, to_mapping)
    if change.kind in ("coupled positions", "coupled joints"):
        return _coupled(mapping, change, both)
    if change.kind == "time scale":
        return _slower(mapping, change.factor)
    matrices = {"q": change.position, "v": change.velocity, "a": change.velocity, "tau": change.torque}
    channels = dict(mapping.channels)
    for name, matrix in matrices.items():
        if matrix is not None and name in channels:
            channels[name] = _multiplied(channels[name], matrix[both])
    if change.position is not None:
        to_joints, zero = _to_joints(original, "q"), original.channels["q"].offset
        moved = to_joints @ change.position[both] @ np.linalg.solve(to_joints, channels["q"].offset - zero)
        channels["q"] = replace(channels["q"], offset=zero + moved)
    if change.zero is not None:
        channels["q"] = replace(channels["q"], offset=channels["q"].offset + change.zero[to_mapping])
    if change.kind == "late torque" and "tau" in channels:
        late = np.isin(to_mapping, change.joints) * change.factor
        channels["tau"] = replace(channels["tau"], delays=channels["tau"].delays + late)
    return replace(mapping, channels=channels)


def _slower(mapping: ColumnMapping, factor: float) -> ColumnMapping:
    """The mapping with the times multiplied by a factor."""
    if mapping.time is None:
        return replace(mapping, rate=None if mapping.rate is None else mapping.rate / factor)
    time = mapping.time
    return replace(mapping, time=replace(time, factor=time.factor * factor, gain=time.gain * factor))


def _coupled(mapping: ColumnMapping, change: Change, both: tuple[NDArray[np.intp], ...]) -> ColumnMapping:
    """The mapping with columns that a transmission couples."""
    assert change.position is not None
    n = len(mapping.joints)
    motor = {name: channel.motor for name, channel in mapping.channels.items()}
    given = mapping.transmission or Transmission(np.eye(n), np.eye(n))
    torque_matrix = given.torque_matrix if motor.get("tau") else np.eye(n)
    if change.torque is not None:
        torque_matrix = torque_matrix @ change.torque[both]
    matrix: Array = np.asarray(np.linalg.solve(change.position[both], given.matrix if motor["q"] else np.eye(n)))
    channels = {
        name: replace(channel, motor=name in ("q", "v", "a") or change.torque is not None or channel.motor)
        if name != "temperature"
        else channel
        for name, channel in mapping.channels.items()
    }
    return replace(mapping, channels=channels, transmission=Transmission(matrix, torque_matrix))


def _multiplied(channel: Channel, matrix: Array) -> Channel:
    """The channel whose columns, in SI units, are multiplied by a matrix with one entry per row."""
    order = np.argmax(np.abs(matrix), axis=1)
    scale = matrix[np.arange(len(matrix)), order]
    return replace(
        channel,
        columns=tuple(channel.columns[k] for k in order),
        factor=channel.factor[order] * scale,
        signs=channel.signs[order] * np.where(scale < 0, -1.0, 1.0),
        delays=channel.delays[order],
    )


def _lines(before: ColumnMapping, after: ColumnMapping) -> tuple[str, ...]:
    """The lines that make one mapping the other."""
    lines: list[str] = []
    if after.rate != before.rate:
        lines.append(f"rate = {after.rate:.9g}")
    if after.time is not None and after.time != before.time:
        lines += ["[time]", f"gain = {after.time.gain:.6g}"]
    for name in MAPPED_QUANTITIES:
        if name not in after.channels:
            continue
        keys = _keys(name, before.channels[name], after.channels[name])
        if keys is None:
            return ()
        if keys:
            lines += [f"[{name}]", *(f"{key} = {value}" for key, value in keys.items())]
    if after.transmission is not None and after.transmission is not before.transmission:
        matrix, torque_matrix = after.transmission.matrix, after.transmission.torque_matrix
        lines += ["[transmission]", f"matrix = {_matrix(matrix)}", f"torque_matrix = {_matrix(torque_matrix)}"]
    return tuple(lines)


def _keys(name: str, before: Channel, after: Channel) -> dict[str, str] | None:
    """Keys of a table with new values; None if no key has the value that is needed."""
    keys: dict[str, str] = {}
    sizes = after.factor * after.signs
    resized = not np.allclose(sizes, before.factor * before.signs, rtol=FACTOR_TOLERANCE, atol=0)
    with_gain = resized and name == "tau"
    if before.columns != after.columns:
        keys["columns"] = "[" + ", ".join(_toml(column) for column in after.columns) + "]"
    if resized:
        units = [
            _unit(name, 1.0 if with_gain else size, slides) for size, slides in zip(sizes, after.slides, strict=True)
        ]
        if None in units and name != "temperature":
            with_gain, units = True, [_unit(name, 1.0, slides) for slides in after.slides]
        if None in units:
            return None
        quoted = [f'"{unit}"' for unit in units]
        keys["unit"] = quoted[0] if len(set(quoted)) == 1 else "[" + ", ".join(quoted) + "]"
    if with_gain or not np.array_equal(before.signs, after.signs):
        keys["sign"] = _numbers(after.signs)
    if with_gain:
        keys["gain"] = _numbers(sizes)
    if before.motor != after.motor:
        keys["side"] = '"motor"'
    if not np.array_equal(before.offset, after.offset):
        degrees = np.rad2deg(after.offset)
        in_degrees = np.where(np.abs(degrees - 360) < FACTOR_TOLERANCE, 0.0, degrees)
        keys["offset"] = _numbers(after.offset if any(after.slides) else in_degrees)
        keys["offset_unit"] = '"rad"' if any(after.slides) else '"deg"'
    if not np.array_equal(before.delays, after.delays):
        keys["delay"] = _numbers(np.round(after.delays, 4))
    return keys


def _unit(name: str, size: float, slides: bool | None) -> str | None:
    """The unit with this factor; None if there is none."""
    units = SLIDING_UNITS[name] if slides else TURNING_UNITS[name]
    return next((unit for unit, factor in units.items() if abs(size / factor - 1) < FACTOR_TOLERANCE), None)


def _toml(column: str | int) -> str:
    if isinstance(column, int):
        return str(column)
    return '"' + column.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _matrix(values: Array) -> str:
    return "[" + ", ".join(map(_numbers, values)) + "]"


def _numbers(values: Array) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in values) + "]"
