"""The mapping of columns to joint coordinates, a small TOML file; docs/recordings.md describes its keys.

The toml_ functions check values of a TOML document.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from reprlib import repr as shown
from typing import Any

import numpy as np

from crosscheck.recordings.errors import BadMapping
from crosscheck.recordings.mapping.units import Unit, known_unit
from crosscheck.recordings.table import is_exact
from graphdyn import InvalidInput
from graphdyn.errors import counted
from graphdyn.layout import Array
from urdf.document import parsed_toml


def toml_square(table: Mapping[str, Any], key: str, n: int, where: str) -> Array:
    """A matrix of n rows of n finite numbers (n, n). Raises BadMapping."""
    rows = table[key]
    if not isinstance(rows, list) or len(rows) != n:
        raise BadMapping(f"{where}: {key} needs {counted(n, 'row')} of {counted(n, 'number')}")
    return np.array([toml_numbers({key: row}, key, n, 0.0, where) for row in rows])


def toml_numbers(table: Mapping[str, Any], key: str, n: int, default: float, where: str) -> Array:
    """A vector of n finite numbers; a single number is repeated n times. Raises BadMapping."""
    value = table.get(key, default)
    values = [value] * n if is_number(value) else value
    if not isinstance(values, list) or len(values) != n or not all(map(is_number, values)):
        raise BadMapping(f"{where}: {key} is {value!r}; give {counted(n, 'number')}")
    return np.array(values, dtype=float)


def is_number(value: Any) -> bool:
    """Whether a double holds the value: integers of TOML have any number of digits."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and is_exact(value)


def toml_text(table: Mapping[str, Any], key: str, where: str) -> str | None:
    """A text, or None if the key is missing. Raises BadMapping."""
    value = table.get(key)
    if value is not None and not isinstance(value, str):
        raise BadMapping(f"{where}: {key} is {value!r}; give a text in quotes")
    return value


def toml_table(document: Mapping[str, Any], key: str, source: str) -> Mapping[str, Any]:
    """A table of the document. Raises BadMapping."""
    if not isinstance(document[key], dict):
        raise BadMapping(f"{source}: {key} is {document[key]!r}; make it a table: [{key}]")
    return dict(document[key])


def refuse_unknown(table: Mapping[str, Any], known: tuple[str, ...], where: str) -> None:
    """Raise BadMapping for a key that is not known."""
    unknown = [key for key in table if key not in known]
    if unknown:
        raise BadMapping(f"{where}: unknown key {unknown[0]!r}; known are {', '.join(known)}")


def toml_column(table: Mapping[str, Any], key: str, where: str) -> str | int:
    """The name of a column, or its number from 1. Raises BadMapping."""
    value = table.get(key)
    if not isinstance(value, str | int) or isinstance(value, bool):
        raise BadMapping(f"{where}: {key} is {value!r}; give its name, or its number from 1")
    return value


MAPPED_QUANTITIES = ("q", "v", "a", "tau", "temperature")
SI_UNITS = {"q": "rad", "v": "rad/s", "a": "rad/s^2", "tau": "N m", "temperature": "degC"}
_TOP = ("joints", "rate", "prismatic", "delimiter", "decimal", "topic", "time", *MAPPED_QUANTITIES, "transmission")
_MOVING = ("side", "sign")
_CHANNEL = ("columns", "unit", "file")
_ONLY_IN = {
    "q": (*_MOVING, "gain", "offset", "offset_unit"),
    "v": (*_MOVING, "gain"),
    "a": (*_MOVING, "gain"),
    "tau": (*_MOVING, "gain", "delay"),
    "temperature": (),
}


@dataclass(frozen=True)
class Channel:
    """The columns of q, v, a, tau or temperature, in the order of the joints: names, or numbers from 1.

    file: pattern of the name of the file that has them; motor: on the motor's side of the transmission
    factor: SI value per number in the column: unit, sign and gain    (n,)
    offset: added after the transmission                              (n,)
    slides: per joint, whether it is prismatic according to the unit; None if the unit fits both types
    signs: the part of the factor that is a sign             (n,)
    delays: delays of the recorded joint values              (n,) [s]
    """

    columns: tuple[str | int, ...]
    factor: Array
    offset: Array
    slides: tuple[bool | None, ...]
    signs: Array
    delays: Array
    file: str = "*"
    motor: bool = False


@dataclass(frozen=True)
class TimeColumn:
    """The column of the time.

    factor: seconds per number: unit and gain
    gain: true time per time of the clock
    nanoseconds: a second column, of ROS stamps, whose nanoseconds are added to the seconds
    """

    column: str | int
    factor: float = 1.0
    file: str = "*"
    nanoseconds: str | int | None = None
    gain: float = 1.0

    @property
    def columns(self) -> tuple[str | int, ...]:
        """The one or two columns of the time."""
        return (self.column,) if self.nanoseconds is None else (self.column, self.nanoseconds)


@dataclass(frozen=True)
class Transmission:
    """q_motor = matrix q, tau = torque_matrix tau_motor, (n, n) each."""

    matrix: Array
    torque_matrix: Array


@dataclass(frozen=True)
class ColumnMapping:
    """A whole mapping; source: its file, or "by name"; rate [Hz], None if a column holds the time.

    delimiter, decimal: signs between two cells and in numbers of a text file; None: as its content shows
    """

    source: str
    joints: tuple[str, ...]
    channels: Mapping[str, Channel]
    time: TimeColumn | None = None
    rate: float | None = None
    transmission: Transmission | None = None
    prismatic: tuple[bool, ...] | None = None
    delimiter: str | None = None
    decimal: str | None = None
    topic: str | None = None


def load_mapping(path: str | PathLike[str]) -> ColumnMapping:
    """Read a mapping. Raises BadMapping, with table and key, and OSError."""
    content = Path(path).read_bytes()
    try:
        return mapping_of(parsed_toml(content), str(path))
    except ValueError as error:
        if isinstance(error, InvalidInput):
            raise
        raise BadMapping(f"{path}: {error}; write it as docs/recordings shows") from error


def given_mapping(mapping: ColumnMapping | str | PathLike[str] | None, rate: float | None) -> ColumnMapping | None:
    """The mapping, or that of the file, with the rate that is given beside it. Raises as load_mapping, InvalidInput."""
    if rate is not None and not 0 < rate < np.inf:
        raise InvalidInput(f"rate is {rate!r}; give samples per second")
    if isinstance(mapping, str | PathLike):
        mapping = load_mapping(mapping)
    return mapping if mapping is None or rate is None else replace(mapping, rate=rate)


def mapping_of(document: Mapping[str, Any], source: str) -> ColumnMapping:
    """The mapping that a parsed TOML document describes. Raises BadMapping."""
    refuse_unknown(document, _TOP, source)
    joints = document.get("joints")
    if not isinstance(joints, list) or not joints or not all(isinstance(name, str) for name in joints):
        raise BadMapping(f'{source}: joints is missing or not a list of names; write joints = ["joint_1", …]')
    if len(set(joints)) < len(joints):
        raise BadMapping(f"{source}: a joint is named twice; name each joint differently")
    if "q" not in document:
        raise BadMapping(f"{source}: without [q]; say which columns hold the joint positions")
    rate, prismatic = document.get("rate"), document.get("prismatic")
    if rate is not None and not (is_number(rate) and rate > 0):
        raise BadMapping(f"{source}: rate is {shown(rate)}; give samples per second")
    if rate is None and "time" not in document:
        raise BadMapping(f"{source}: without [time]; name its column, or give the rate in samples per second")
    if prismatic is not None and (
        not isinstance(prismatic, list) or [type(slides) for slides in prismatic] != [bool] * len(joints)
    ):
        given = shown(prismatic)
        raise BadMapping(f"{source}: prismatic is {given}; give true or false for each joint")
    channels = {
        name: _channel(name, toml_table(document, name, source), tuple(joints), f"{source}, [{name}]")
        for name in MAPPED_QUANTITIES
        if name in document
    }
    transmission = None
    if "transmission" in document:
        transmission = _transmission(
            toml_table(document, "transmission", source), len(joints), f"{source}, [transmission]"
        )
    elif any(channel.motor for channel in channels.values()):
        raise BadMapping(f'{source}: side = "motor" without [transmission]; give its ratio or matrix')
    if transmission is not None and not any(channel.motor for channel in channels.values()):
        raise BadMapping(f'{source}: [transmission] without side = "motor"; say which columns are in front of it')
    delimiter = toml_text(document, "delimiter", source)
    if delimiter is not None and (len(delimiter) != 1 or delimiter in '\r\n"'):
        raise BadMapping(f"{source}: delimiter is {shown(delimiter)}; give the one character between two cells")
    decimal = toml_text(document, "decimal", source)
    if decimal not in (None, ".", ","):
        raise BadMapping(f'{source}: decimal is {shown(decimal)}; give the decimal sign of the file, "." or ","')
    return ColumnMapping(
        source,
        tuple(joints),
        channels,
        time=_time(toml_table(document, "time", source), f"{source}, [time]") if "time" in document else None,
        rate=None if rate is None else float(rate),
        transmission=transmission,
        prismatic=None if prismatic is None else tuple(prismatic),
        delimiter=delimiter,
        decimal=decimal,
        topic=toml_text(document, "topic", source),
    )


def _channel(name: str, table: Mapping[str, Any], joints: tuple[str, ...], where: str) -> Channel:
    refuse_unknown(table, (*_CHANNEL, *_ONLY_IN[name]), where)
    n = len(joints)
    columns = table.get("columns")
    if isinstance(columns, str) and (name == "temperature" or "{number}" in columns or "{joint}" in columns):
        columns = [
            columns.replace("{number}", str(number)).replace("{joint}", joint)
            for number, joint in enumerate(joints, start=1)
        ]
    if not isinstance(columns, list) or len(columns) != n or not all(type(column) in (str, int) for column in columns):
        raise BadMapping(
            f"{where}: columns is {shown(columns)}; give {counted(n, 'name')} or numbers from 1, or a text with "
            "{number} or {joint}"
        )
    units = table.get("unit", SI_UNITS[name])
    units = [units] * n if isinstance(units, str) else units
    if not isinstance(units, list) or len(units) != n or not all(isinstance(unit, str) for unit in units):
        raise BadMapping(f"{where}: unit is {shown(units)}; give one text, or one per joint")
    known: list[Unit] = [known_unit(name, unit, where) for unit in units]
    if any(unit.needs_gain for unit in known) and "gain" not in table:
        raise BadMapping(
            f"{where}: {units[0]!r} is not a unit of torque; give the gain in N m per {units[0]}, or "
            "gain = 1 for `graphdyn payload` and `identify --currents`, which find it"
        )
    side = table.get("side", "joint")
    if side not in ("joint", "motor"):
        raise BadMapping(f'{where}: side is {shown(side)}; use "joint" or "motor"')
    sign = toml_numbers(table, "sign", n, 1.0, where)
    if np.any(np.abs(sign) != 1):
        raise BadMapping(f"{where}: sign is {shown(table['sign'])}; use 1 and -1")
    offset_unit = known_unit(name, table.get("offset_unit", SI_UNITS[name]), f"{where}: offset_unit")
    return Channel(
        tuple(columns),
        np.array([unit.factor for unit in known]) * sign * toml_numbers(table, "gain", n, 1.0, where),
        toml_numbers(table, "offset", n, 0.0, where) * offset_unit.factor,
        tuple(unit.slides for unit in known),
        file=toml_text(table, "file", where) or "*",
        motor=side == "motor",
        signs=sign,
        delays=toml_numbers(table, "delay", n, 0.0, where),
    )


def _time(table: Mapping[str, Any], where: str) -> TimeColumn:
    refuse_unknown(table, ("column", "unit", "gain", "file", "nanoseconds"), where)
    column = toml_column(table, "column", where)
    nanoseconds = toml_column(table, "nanoseconds", where) if "nanoseconds" in table else None
    unit = toml_text(table, "unit", where) or "s"
    if nanoseconds is not None and unit != "s":
        raise BadMapping(f"{where}: unit is {unit!r}, but beside nanoseconds the column holds seconds; leave it out")
    gain = float(toml_numbers(table, "gain", 1, 1.0, where)[0])
    if not gain > 0:
        raise BadMapping(f"{where}: gain is {gain:g}; give the true time per recorded time, above zero")
    factor, file = gain * known_unit("time", unit, where).factor, toml_text(table, "file", where) or "*"
    return TimeColumn(column, factor, file, nanoseconds, gain)


def _transmission(table: Mapping[str, Any], n: int, where: str) -> Transmission:
    refuse_unknown(table, ("ratio", "matrix", "torque_matrix"), where)
    if ("ratio" in table) == ("matrix" in table):
        raise BadMapping(f"{where}: give either ratio or matrix")
    if "ratio" in table:
        matrix = np.diag(toml_numbers(table, "ratio", n, 1.0, where))
    else:
        matrix = toml_square(table, "matrix", n, where)
    if np.linalg.matrix_rank(matrix) < n:
        raise BadMapping(f"{where}: the matrix is singular, so motors do not determine joints; check its entries")
    torque_matrix = toml_square(table, "torque_matrix", n, where) if "torque_matrix" in table else matrix.T
    return Transmission(matrix, torque_matrix)
