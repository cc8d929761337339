"""The configuration of a study: a TOML file, or one of those that come with the package, by name."""

from __future__ import annotations

import hashlib
import tomllib
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.identifying import METHODS
from crosscheck.studies.identification.scenarios import Scenario, scenarios
from crosscheck.studies.identification.settings import (
    BadConfiguration,
    Numbers,
    Settings,
    not_negative,
    number,
    one_or_each,
    positive,
    whole,
    words,
)
from graphdyn.identification import Estimator

SHIPPED = ("small", "birdy")
"""Configurations that come with the package."""

TABLES = ("study", "robot", "errors", "scenario", "grid")


@dataclass(frozen=True)
class RobotSettings:
    """The robot as it is, its controller, and the limits of its motions. One number for all joints, or one each.

    file: of the configuration, for messages
    name: of the catalogue, or path of a file; locked: joints that stand still at zero
    viscous, coulomb, rotor_inertia: of the drives   [N m s/rad, N m, kg m²; sliding joints in N and kg]
    position_gain, velocity_gain: of the PD controller; without them from the inertia at q = 0   [N m/rad, N m s/rad]
    velocity_noise: of the velocities that the controller sees   [rad/s or m/s]
    lower, upper: of positions, those of the file if left out   [rad or m]
    velocity, acceleration: largest ones of random and excited motions and steps   [rad/s, rad/s²; m/s, m/s²]
    """

    file: str
    name: str
    locked: tuple[str, ...] = ()
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


@dataclass(frozen=True)
class ErrorSettings:
    """How large the errors of the model are, where a scenario has one.

    torque_factor: recorded torque over true one, of "gear"
    payload_mass, payload_center: of "payload"; a point in link axes of the last body   [kg, m]
    joint_stiffness, joint_damping: of "flexible", the damping as a ratio to the critical one   [N m/rad, -]
    """

    torque_factor: Numbers = 1.05
    payload_mass: float = 2.0
    payload_center: tuple[float, ...] = (0.0, 0.0, 0.1)
    joint_stiffness: Numbers = 2e4
    joint_damping: Numbers = 0.02


@dataclass(frozen=True)
class Configuration:
    """What to simulate, and what to identify with.

    file: name for messages; text: of the file
    seed: of all random numbers; runs: of every scenario
    methods: names (METHODS), or FILE.py:NAME with the whole path of the file
    """

    file: str
    text: str
    seed: int
    runs: int
    methods: tuple[str, ...]
    robot: RobotSettings
    errors: ErrorSettings
    scenarios: tuple[Scenario, ...]

    @property
    def own_files(self) -> dict[str, str]:
        """Hash of every file that the study reads beside its configuration: own methods, and the robot's."""
        paths = [method.rpartition(":")[0] for method in self.methods if ":" in method]
        if Path(self.robot.name).is_file():
            paths.append(self.robot.name)
        return {path: hashlib.sha256(Path(path).read_bytes()).hexdigest() for path in paths}


def read_configuration(name: str) -> Configuration:
    """One of SHIPPED, or a file. Raises BadConfiguration, OSError."""
    path = Path(name)
    if name in SHIPPED:
        content = (resources.files(__package__) / "configurations" / f"{name}.toml").read_bytes()
    elif not path.is_file():
        raise BadConfiguration(f"there is no file {name}; name a configuration, or one of {', '.join(SHIPPED)}")
    else:
        content = path.read_bytes()
    return configuration_of(content, name, path.resolve().parent)


def configuration_of(content: bytes, file: str, folder: Path) -> Configuration:
    """file: for messages; folder: in which paths of the configuration begin. Raises BadConfiguration."""
    try:
        text = content.decode()
        document = tomllib.loads(text)
    except UnicodeDecodeError as error:
        raise BadConfiguration(f"{file}: is no UTF-8 text (byte {error.start}); save it as UTF-8") from None
    except tomllib.TOMLDecodeError as error:
        raise BadConfiguration(f"{file}: is no TOML: {error}") from None
    for table in document:
        if table not in TABLES:
            raise BadConfiguration(f"{file}: [{table}] is no table of a study; it has: {', '.join(TABLES)}")
    grids = document.get("grid", [{}])
    if not isinstance(grids, list):
        raise BadConfiguration(f"{file}: [grid] must be [[grid]], which can be given several times")
    tables = {name: document.get(name, {}) for name in TABLES[:-1]}
    for name, table in [*tables.items(), *(("grid", grid) for grid in grids)]:
        if not isinstance(table, dict):
            raise BadConfiguration(f"{file}: {name} is {table!r}; it must be a table, [{name}]")
    study, robot, errors, common = (Settings(file, name, table) for name, table in tables.items())
    numbered = [Settings(file, f"grid {k}" if len(grids) > 1 else "grid", grid) for k, grid in enumerate(grids, 1)]
    points = scenarios(common, numbered)
    everything = _measurable(points)
    found = Configuration(
        file,
        text,
        study.take("seed", 0, whole(0)),
        study.take("runs", 5, whole(1)),
        study.take("methods", everything, _methods(folder, everything)),
        _robot(robot, folder),
        _errors(errors),
        points,
    )
    study.refuse_others()
    _check(found, study, robot)
    return found


def _check(study: Configuration, table: Settings, robot: Settings) -> None:
    """Raises BadConfiguration for a scenario that this robot cannot have, or no method can use, and the reverse."""
    measured = {scenario.force_noise is not None for scenario in study.scenarios}
    need = [name for name in study.methods if name in METHODS and takes_wrenches(METHODS[name]())]
    if need and (measured == {False} or (False in measured and len(need) == len(study.methods))):
        where = "no scenario" if measured == {False} else "not every scenario"
        what = f"has {', '.join(need)} for wrenches, which {where} measures; give a force_noise, or other methods"
        raise table.error("methods", what)
    errors = {scenario.model_error for scenario in study.scenarios}
    if "friction" in errors and not np.any(study.robot.coulomb):
        raise robot.error("coulomb", 'is zero, and the model error "friction" forgets it; give numbers above zero')
    if "flexible" in errors and not np.all(study.robot.rotor_inertia):
        raise robot.error("rotor_inertia", 'must be above zero in all joints for the model error "flexible"')


def _robot(table: Settings, folder: Path) -> RobotSettings:
    if "name" not in table.values:
        raise table.error("name", "is missing; give a robot of `graphdyn robots`, or a file")
    each = one_or_each(not_negative)
    readers: dict[str, Any] = {
        "name": lambda value: _path(folder, words(value)),
        "locked": _texts("names of joints"),
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
    return RobotSettings(table.file, **given)


def _errors(table: Settings) -> ErrorSettings:
    readers: dict[str, Any] = {
        "torque_factor": one_or_each(positive),
        "payload_mass": not_negative,
        "payload_center": _three,
        "joint_stiffness": one_or_each(positive),
        "joint_damping": one_or_each(not_negative),
    }
    return ErrorSettings(**_given(ErrorSettings, table, readers))


def _given(kind: Any, table: Settings, readers: dict[str, Any]) -> dict[str, Any]:
    """The fields that the table has."""
    names = [field.name for field in fields(kind) if field.name in readers]
    given = {name: table.take(name, None, readers[name]) for name in names}
    table.refuse_others()
    return {name: value for name, value in given.items() if name in table.values}


def _three(value: object) -> tuple[float, ...]:
    if isinstance(value, list) and len(value) == 3:
        return tuple(number(x) for x in value)
    raise ValueError("give three numbers")


def _texts(what: str) -> Any:
    def read(value: object) -> tuple[str, ...]:
        if isinstance(value, list) and all(isinstance(one, str) for one in value):
            return tuple(value)
        raise ValueError(f"give a list of {what}")

    return read


def _measurable(points: Sequence[Scenario]) -> tuple[str, ...]:
    """All methods; those that take wrenches for measured only where a scenario measures them."""
    wrenches = any(scenario.force_noise is not None for scenario in points)
    return tuple(name for name, made in METHODS.items() if wrenches or not takes_wrenches(made()))


def shown_name(method: str) -> str:
    """For tables: as in METHODS; of an own one FILE:NAME without its folder."""
    where, colon, name = method.rpartition(":")
    return f"{Path(where).stem}:{name}" if colon else method


def takes_wrenches(estimator: Estimator) -> bool:
    """It asks for a recording, which has joint wrenches, beside the problem."""
    return hasattr(estimator, "recording")


def _methods(folder: Path, everything: tuple[str, ...]) -> Callable[[object], tuple[str, ...]]:
    def read(value: object) -> tuple[str, ...]:
        names = everything if value == "all" else _texts('methods, or "all"')(value)
        found = dict.fromkeys(
            one for name in names for one in (everything if name == "all" else (_method(folder, name),))
        )
        if not found:
            raise ValueError('give methods, or "all"')
        for name, times in Counter(map(shown_name, found)).items():
            if times > 1:
                raise ValueError(f"several are called {name} in tables, which name no folders; rename a file")
        return tuple(found)

    return read


def _method(folder: Path, name: str) -> str:
    where, _, function = name.rpartition(":")
    if where.endswith(".py") and function:
        path = (folder / where).resolve()
        if path.is_file():
            return f"{path}:{function}"
        raise ValueError(f"there is no file {path}")
    if name in METHODS:
        return name
    raise ValueError(f"there is no method '{name}'; use {', '.join(METHODS)}, all, or FILE.py:NAME")


def _path(folder: Path, name: str) -> str:
    """A file beside the configuration, or a name as it is."""
    there = folder / name
    return str(there.resolve()) if there.is_file() else name
