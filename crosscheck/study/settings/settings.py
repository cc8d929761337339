"""Tables of a TOML file, read key by key: every error names the file and the key, and says what to give.

Two of the tables are here: the robot, and the errors of its model.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, TypeVar, get_args

from graphdyn import InvalidInput
from graphdyn.arguments import closest
from urdf import Reading
from urdf.reading import Mimic

T = TypeVar("T")

Numbers = float | tuple[float, ...]
"""One number for all joints, or one for each."""


class BadConfiguration(InvalidInput):
    """A configuration of a study that cannot be used; the message names the file, the key and the remedy."""


@dataclass(eq=False)
class Settings:
    """One table of the file; keys that were never asked for are refused by `refuse_others`."""

    file: str
    name: str
    values: Mapping[str, Any]
    _known: list[str] = field(default_factory=list)

    def take(self, key: str, default: T, read: Callable[[Any], T]) -> T:
        """What `read` makes of the value; it raises ValueError with what is needed. The default without the key."""
        self._known.append(key)
        if key not in self.values:
            return default
        try:
            return read(self.values[key])
        except ValueError as needed:
            raise self.error(key, f"is {self.values[key]!r}; {needed}") from None

    def error(self, key: str, message: str) -> BadConfiguration:
        return BadConfiguration(f"{self.file}: {key} in [{self.name}] {message}")

    def refuse_others(self) -> None:
        """Raises BadConfiguration for a key that nothing asked for."""
        for key in self.values:
            if key not in self._known:
                near = closest(key, self._known)
                meant = f"did you mean {near}?" if near else f"it has: {', '.join(self._known)}"
                raise self.error(key, f"is no setting of this table; {meant}")


def number(value: object, *, least: float = -math.inf, above: float = -math.inf) -> float:
    """A finite number from `least` on, and above `above`. Raises ValueError."""
    real = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
    if real and least <= value and value > above:  # type: ignore[operator]
        return float(value)  # type: ignore[arg-type]
    bound = f" above {above:g}" if above > -math.inf else f" from {least:g} on" if least > -math.inf else ""
    raise ValueError(f"give a number{bound}")


def positive(value: object) -> float:
    return number(value, above=0.0)


def not_negative(value: object) -> float:
    return number(value, least=0.0)


def whole(least: int, most: int | None = None) -> Callable[[object], int]:
    """A reader of whole numbers from `least` on, to `most`."""

    def read(value: object) -> int:
        if isinstance(value, int) and most is not None and value > most:
            raise ValueError(f"give {most} or less")
        if isinstance(value, int) and not isinstance(value, bool) and value >= least:
            return value
        raise ValueError(f"give a whole number from {least} on")

    return read


def one_or_each(read: Callable[[object], float]) -> Callable[[object], Numbers]:
    """A reader of one number, or of a list with one for each joint."""

    def several(value: object) -> Numbers:
        return tuple(read(x) for x in value) if isinstance(value, list) and value else read(value)

    return several


def words(value: object) -> str:
    if isinstance(value, str) and value:
        return value
    raise ValueError("give a text")


def yes_or_no(value: object) -> bool:
    if isinstance(value, bool):
        return value
    raise ValueError("give true or false")


def one_of(choices: Sequence[str]) -> Callable[[object], str]:
    """A reader of one of these words."""

    def read(value: object) -> str:
        if isinstance(value, str) and value in choices:
            return value
        raise ValueError(f"use one of {', '.join(choices)}")

    return read


def texts(what: str) -> Callable[[object], tuple[str, ...]]:
    """A reader of lists of texts; what they are, for its error."""

    def read(value: object) -> tuple[str, ...]:
        if isinstance(value, list) and all(isinstance(one, str) for one in value):
            return tuple(value)
        raise ValueError(f"give a list of {what}")

    return read


@dataclass(frozen=True)
class RobotSettings:
    """The robot as it is, its controller, and the limits of its motions. One number for all joints, or one each.

    file: of the configuration, for messages
    name: of the catalog, or path of a file; label: in scenarios and tables
    locked: joints that stand still at zero; chain, gravity, mimic, repair: as in urdf.Reading
    viscous, coulomb, rotor_inertia: of the drives   [N m s/rad, N m, kg m²; sliding joints in N and kg]
    position_gain, velocity_gain: of the PD controller; without them from the inertia at q = 0   [N m/rad, N m s/rad]
    velocity_noise: of the velocities that the controller sees   [rad/s or m/s]
    lower, upper: of positions, those of the file if left out   [rad or m]
    velocity, acceleration: largest ones of random and excited motions and steps   [rad/s, rad/s²; m/s, m/s²]
    """

    file: str
    name: str
    label: str
    locked: tuple[str, ...] = ()
    chain: tuple[str, ...] | None = None
    gravity: tuple[float, ...] | None = None
    mimic: Mimic = "coupled"
    repair: tuple[str, ...] = ()
    viscous: Numbers = 0.0
    coulomb: Numbers = 0.0
    rotor_inertia: Numbers = 0.0
    position_gain: Numbers | None = None
    velocity_gain: Numbers | None = None
    velocity_noise: float = 1e-4
    lower: Numbers | None = None
    upper: Numbers | None = None
    velocity: Numbers = 2.0
    acceleration: Numbers = 10.0

    @property
    def reading(self) -> Reading:
        chain = None if self.chain is None else (self.chain[0], self.chain[1])
        return Reading(
            lock=self.locked or None, chain=chain, gravity=self.gravity, mimic=self.mimic, repair=self.repair
        )


@dataclass(frozen=True)
class ErrorSettings:
    """How large the errors of the model are, where a scenario has one.

    torque_factor: recorded torque over true one, of "gear"
    payload_mass, payload_center: of "payload"; a point in link axes of the last body   [kg, m]
    joint_stiffness, joint_damping: of "flexible", the damping as a ratio to the critical one   [N m/rad, -]
    gain_factor: true gains over known ones, of "gains"
    position_step, torque_step: of encoders and recorded torques, of "quantized"   [rad or m, N m or N]
    breakaway, stribeck_velocity: breakaway torque over coulomb, and speed at which half of what it is more is left, of
        "stribeck" and "lugre"   [-, rad/s or m/s]
    presliding: deflection of the bristles at which the torque is that of coulomb, of "lugre"   [rad or m]
    """

    torque_factor: Numbers = 1.05
    payload_mass: float = 2.0
    payload_center: tuple[float, ...] = (0.0, 0.0, 0.1)
    joint_stiffness: Numbers = 2e4
    joint_damping: Numbers = 0.02
    gain_factor: Numbers = 1.05
    position_step: Numbers = 5e-5
    torque_step: Numbers = 0.1
    breakaway: Numbers = 1.5
    stribeck_velocity: Numbers = 0.05
    presliding: Numbers = 1e-3


def robot_settings(table: Settings, folder: Path) -> RobotSettings:
    if "name" not in table.values:
        raise table.error("name", "is missing; give a robot of `graphdyn robots`, or a file")
    each = one_or_each(not_negative)
    readers: dict[str, Any] = {
        "name": lambda value: _path(folder, words(value)),
        "label": words,
        "locked": texts("names of joints"),
        "chain": _base_and_tip,
        "gravity": _three,
        "mimic": one_of(get_args(Mimic)),
        "repair": texts("names of repairs"),
        "velocity_noise": not_negative,
        "position_gain": each,
        "velocity_gain": each,
        "viscous": each,
        "coulomb": each,
        "rotor_inertia": each,
        "lower": one_or_each(number),
        "upper": one_or_each(number),
        "velocity": one_or_each(positive),
        "acceleration": one_or_each(positive),
    }
    given = _given(RobotSettings, table, readers)
    if ("position_gain" in given) != ("velocity_gain" in given):
        raise table.error("position_gain", "and velocity_gain belong together; give both, or none")
    return RobotSettings(table.file, **{"label": Path(given["name"]).stem} | given)


def all_robots(tables: Sequence[Settings], folder: Path) -> tuple[RobotSettings, ...]:
    """Raises BadConfiguration for two of one label."""
    found = tuple(robot_settings(table, folder) for table in tables)
    for k, robot in enumerate(found):
        if robot.label in [other.label for other in found[:k]]:
            raise tables[k].error("label", f"is '{robot.label}', as that of another robot; give a label of its own")
    return found


def error_settings(table: Settings) -> ErrorSettings:
    readers: dict[str, Any] = {
        "torque_factor": one_or_each(positive),
        "payload_mass": not_negative,
        "payload_center": _three,
        "joint_stiffness": one_or_each(positive),
        "joint_damping": one_or_each(not_negative),
        "breakaway": one_or_each(lambda value: number(value, least=1.0)),
        **dict.fromkeys(("gain_factor", "position_step", "torque_step"), one_or_each(positive)),
        **dict.fromkeys(("stribeck_velocity", "presliding"), one_or_each(positive)),
    }
    return ErrorSettings(**_given(ErrorSettings, table, readers))


def _given(kind: Any, table: Settings, readers: dict[str, Any]) -> dict[str, Any]:
    """The fields that the table has."""
    names = [field.name for field in fields(kind) if field.name in readers]
    given = {name: table.take(name, None, readers[name]) for name in names}
    table.refuse_others()
    return {name: value for name, value in given.items() if name in table.values}


def _base_and_tip(value: object) -> tuple[str, ...]:
    names = texts("names of links")(value)
    if len(names) != 2:
        raise ValueError("give the names of two links: base and tip of an arm")
    return names


def _three(value: object) -> tuple[float, ...]:
    if isinstance(value, list) and len(value) == 3:
        return tuple(number(x) for x in value)
    raise ValueError("give three numbers")


def _path(folder: Path, name: str) -> str:
    """A file beside the configuration, or a name as it is."""
    there = folder / name
    return str(there.resolve()) if there.is_file() else name
