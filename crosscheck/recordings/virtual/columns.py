"""Columns of a virtual recording: one per number, named after joint or body, with the unit in the header.

For joint O1 and body B1: robot (its name, in every row); time [s]; O1.q [rad], O1.v [rad/s], O1.a [rad/s^2],
O1.tau [N m] (in m, m/s, m/s^2, N for a prismatic joint); and in world axes B1.alpha [rad], B1.r_x [m],
B1.r_ddot_x [m/s^2], B1.omega_x [rad/s], B1.omega_dot_x [rad/s^2], B1.F_x [N], B1.M_x [N m], with all components.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from crosscheck.recordings.errors import BadRecordingFile

JOINT_UNITS = {"q": ("rad", "m"), "v": ("rad/s", "m/s"), "a": ("rad/s^2", "m/s^2"), "tau": ("N m", "N")}
"""Units of a joint's channels, for a revolute and a prismatic joint; the channel is its own symbol."""

BODY_CHANNEL_COLUMNS = {
    "cardano": ("rad", ("alpha", "beta", "gamma")),
    "position": ("m", ("r_x", "r_y", "r_z")),
    "acceleration": ("m/s^2", ("r_ddot_x", "r_ddot_y", "r_ddot_z")),
    "angular_velocity": ("rad/s", ("omega_x", "omega_y", "omega_z")),
    "angular_acceleration": ("rad/s^2", ("omega_dot_x", "omega_dot_y", "omega_dot_z")),
    "joint_forces": ("N", ("F_x", "F_y", "F_z")),
    "joint_moments": ("N m", ("M_x", "M_y", "M_z")),
}
"""Unit and symbols of the channels of a body."""

ROBOT, TIME = "robot", "time [s]"

_BODY_SYMBOLS = {symbol for _, symbols in BODY_CHANNEL_COLUMNS.values() for symbol in symbols}


class VirtualColumn(NamedTuple):
    """A column: its channel, and its index there, with the channel as an array (N, n) or (N, 3 n)."""

    label: str
    unit: str
    channel: str
    number: int

    @property
    def header(self) -> str:
        return f"{self.label} [{self.unit}]"


class Elements(NamedTuple):
    """Joint names, which of the joints are prismatic, body names (n,): joint j carries body j."""

    joint_names: tuple[str, ...]
    prismatic: tuple[bool, ...]
    body_names: tuple[str, ...]


def columns(elements: Elements) -> list[VirtualColumn]:
    """All columns after robot and time, in the order in which they are written."""
    of_joints = [
        VirtualColumn(f"{joint}.{symbol}", units[slides], symbol, j)
        for j, (joint, slides) in enumerate(zip(elements.joint_names, elements.prismatic, strict=True))
        for symbol, units in JOINT_UNITS.items()
    ]
    of_bodies = [
        VirtualColumn(f"{body}.{symbol}", unit, channel, 3 * i + k)
        for i, body in enumerate(elements.body_names)
        for channel, (unit, symbols) in BODY_CHANNEL_COLUMNS.items()
        for k, symbol in enumerate(symbols)
    ]
    return [*of_joints, *of_bodies]


def elements_of(path: Path, headers: Iterable[str]) -> Elements:
    """The joints and bodies that the headers name, in the order in which they first appear. Raises BadRecordingFile."""
    joints: dict[str, bool] = {}
    bodies: dict[str, None] = {}
    for label, unit in map(_split, headers):
        name, _, symbol = label.rpartition(".")
        if symbol in JOINT_UNITS:
            joints[name] = joints.get(name, False) or (symbol == "q" and unit == "m")
        elif symbol in _BODY_SYMBOLS:
            bodies[name] = None
    if not joints or len(joints) != len(bodies):
        raise BadRecordingFile(
            f"{path}, header: {len(joints)} joints ({', '.join(joints)}), {len(bodies)} bodies ({', '.join(bodies)}); "
            "each joint needs its columns '<joint>.q [rad]' … and its body the columns '<body>.r_x [m]' …"
        )
    return Elements(tuple(joints), tuple(joints.values()), tuple(bodies))


def check_headers(path: Path, headers: list[str], expected: Iterable[VirtualColumn]) -> None:
    """Raise BadRecordingFile unless every expected column occurs once, in its unit, and no other column does."""
    units = dict([_split(ROBOT), _split(TIME)]) | {column.label: column.unit for column in expected}
    seen = set()
    for number, header in enumerate(headers, start=1):
        label, unit = _split(header)
        where = f"{path}, header, column {number} {header!r}"
        if label not in units:
            raise BadRecordingFile(f"{where}: not a column of a recording; remove it")
        if label in seen:
            raise BadRecordingFile(f"{where}: {label!r} occurs twice; keep one")
        if unit != units[label]:
            needed = f"[{units[label]}]" if units[label] else "none"
            raise BadRecordingFile(f"{where}: the unit must be {needed}; convert the numbers and rename the column")
        seen.add(label)
    missing = [f"{label} [{unit}]" if unit else label for label, unit in units.items() if label not in seen]
    if missing:
        names = f"column {missing[0]!r}" + (f" and {len(missing) - 1} more" if len(missing) > 1 else "")
        raise BadRecordingFile(f"{path}, header: without {names}; record every channel of every joint and body")


def _split(header: str) -> tuple[str, str]:
    """Label and unit of 'label [unit]'; a header without brackets has the unit ''."""
    found = re.fullmatch(r"(.*\S)\s*\[([^\[\]]*)\]", header, re.DOTALL)
    return (found[1], found[2]) if found else (header, "")
