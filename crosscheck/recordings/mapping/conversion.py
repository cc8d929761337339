"""Conversion of columns to joint coordinates: unit, sign, gain, then the transmission, then the offset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatch

import numpy as np

from crosscheck.recordings.errors import BadMapping, BadRecordingFile
from crosscheck.recordings.mapping.mapping import ColumnMapping, Transmission
from crosscheck.recordings.table import RecordedTable
from graphdyn.layout import Array


@dataclass(frozen=True, eq=False)
class RecordedColumn:
    """One mapped column: quantity, its table, its position there from 0, its values as recorded (N,)."""

    quantity: str
    table: RecordedTable
    number: int
    values: Array

    @property
    def name(self) -> str:
        return self.table.names[self.number] or str(self.number + 1)


def mapped_columns(tables: Sequence[RecordedTable], mapping: ColumnMapping) -> dict[str, list[RecordedColumn]]:
    """The columns of q, v, a, tau, temperature, and of time if there is one. Raises BadMapping, BadRecordingFile."""
    wanted = {name: (channel.file, channel.columns) for name, channel in mapping.channels.items()}
    if mapping.time is not None:
        wanted["time"] = (mapping.time.file, mapping.time.columns)
    found: dict[str, list[RecordedColumn]] = {}
    for quantity, (pattern, names) in wanted.items():
        where = f"{mapping.source}, [{quantity}]"
        matching = [table for table in tables if fnmatch(table.path.name, pattern)]
        if len(matching) != 1:
            files = ", ".join(str(table.path) for table in tables)
            raise BadMapping(
                f'{where}: {len(matching)} of the files ({files}) match file = "{pattern}"; exactly one must'
            )
        table = matching[0]
        numbers = [table.number(name, where) for name in names]
        times = [number for number in numbers if number in table.seconds and quantity != "time"]
        if times:
            raise BadMapping(f"{where}: {table.names[times[0]]!r} of {table.path} holds times; name another column")
        found[quantity] = [RecordedColumn(quantity, table, number, table.doubles(number)) for number in numbers]
    used = list({column.table.path: column.table for columns in found.values() for column in columns}.values())
    unused = [str(table.path) for table in tables if table.path not in [table.path for table in used]]
    if unused:
        raise BadMapping(f"{mapping.source}: nothing is taken from {unused[0]}; leave the file out, or map its columns")
    counts = [len(table.values) for table in used]
    if len(set(counts)) > 1:
        listed = ", ".join(f"{table.path} {count}" for table, count in zip(used, counts, strict=True))
        raise BadRecordingFile(f"the files do not have the same rows ({listed}); cut them to the same instants")
    return found


def joint_channels(columns: Mapping[str, Sequence[RecordedColumn]], mapping: ColumnMapping) -> dict[str, Array]:
    """q, v, a, tau, temperature (N, n) of the joints in SI units; NaN in a row stays NaN."""
    result = {}
    for name, channel in mapping.channels.items():
        with np.errstate(all="ignore"):  # what is no finite number then has a finding
            values = np.column_stack([column.values for column in columns[name]]) * channel.factor
            if channel.motor and mapping.transmission is not None:
                values = _behind(mapping.transmission, name, values)
            result[name] = values + channel.offset
    return result


def _behind(transmission: Transmission, name: str, values: Array) -> Array:
    if name == "tau":
        return np.asarray(values @ transmission.torque_matrix.T)
    return np.asarray(np.linalg.solve(transmission.matrix, values.T).T)


def sliding_joints(mapping: ColumnMapping, files: str) -> tuple[bool, ...]:
    """Whether each joint is prismatic: by the mapping, otherwise by the units. Raises BadMapping if they disagree.

    files: for messages
    """
    slides = mapping.prismatic or [
        any(channel.slides[j] is True for channel in mapping.channels.values()) for j in range(len(mapping.joints))
    ]
    for name, channel in mapping.channels.items():
        for joint, joint_slides, unit_slides in zip(mapping.joints, slides, channel.slides, strict=True):
            if unit_slides is not None and unit_slides != joint_slides:
                kinds = ("turns", "slides")
                raise BadMapping(
                    f"{files}: {mapping.source}, [{name}]: {joint!r} {kinds[joint_slides]}, its unit is one of a "
                    f"joint that {kinds[unit_slides]}; correct the unit, or prismatic"
                )
    return tuple(slides)
