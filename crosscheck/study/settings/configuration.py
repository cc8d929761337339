"""The configuration of a study: a TOML file, or one of those that come with the package, by name."""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np

from crosscheck.identifying import ESTIMATORS
from crosscheck.study.settings.method_names import measurable_methods, methods_reader, takes_wrenches
from crosscheck.study.settings.robot_settings import ErrorSettings, RobotSettings, error_settings, robot_settings
from crosscheck.study.settings.scenarios import Scenario, scenarios
from crosscheck.study.settings.settings import BadConfiguration, Settings, whole

SHIPPED_CONFIGURATIONS = ("small", "birdy")
"""Configurations that come with the package."""

CONFIGURATION_TABLES = ("study", "robot", "errors", "scenario", "grid")


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
    """One of SHIPPED_CONFIGURATIONS, or a file. Raises BadConfiguration, OSError."""
    path = Path(name)
    if name in SHIPPED_CONFIGURATIONS:
        content = (resources.files("crosscheck.study") / "configurations" / f"{name}.toml").read_bytes()
    elif not path.is_file():
        raise BadConfiguration(
            f"there is no file {name}; name a configuration, or one of {', '.join(SHIPPED_CONFIGURATIONS)}"
        )
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
        if table not in CONFIGURATION_TABLES:
            raise BadConfiguration(
                f"{file}: [{table}] is no table of a study; it has: {', '.join(CONFIGURATION_TABLES)}"
            )
    grids = document.get("grid", [{}])
    if not isinstance(grids, list):
        raise BadConfiguration(f"{file}: [grid] must be [[grid]], which can be given several times")
    tables = {name: document.get(name, {}) for name in CONFIGURATION_TABLES[:-1]}
    for name, table in [*tables.items(), *(("grid", grid) for grid in grids)]:
        if not isinstance(table, dict):
            raise BadConfiguration(f"{file}: {name} is {table!r}; it must be a table, [{name}]")
    study, robot, errors, common = (Settings(file, name, table) for name, table in tables.items())
    numbered = [Settings(file, f"grid {k}" if len(grids) > 1 else "grid", grid) for k, grid in enumerate(grids, 1)]
    points = scenarios(common, numbered)
    everything = measurable_methods(points)
    found = Configuration(
        file,
        text,
        study.take("seed", 0, whole(0)),
        study.take("runs", 5, whole(1)),
        study.take("methods", everything, methods_reader(folder, everything)),
        robot_settings(robot, folder),
        error_settings(errors),
        points,
    )
    study.refuse_others()
    _check(found, study, robot)
    return found


def _check(study: Configuration, table: Settings, robot: Settings) -> None:
    """Raises BadConfiguration for a scenario that this robot cannot have, or no method can use, and the reverse."""
    measured = {scenario.force_noise is not None for scenario in study.scenarios}
    need = [name for name in study.methods if name in ESTIMATORS and takes_wrenches(ESTIMATORS[name]())]
    if need and (measured == {False} or (False in measured and len(need) == len(study.methods))):
        where = "no scenario" if measured == {False} else "not every scenario"
        what = f"has {', '.join(need)} for wrenches, which {where} measures; give a force_noise, or other methods"
        raise table.error("methods", what)
    errors = {scenario.model_error for scenario in study.scenarios}
    if "friction" in errors and not np.any(study.robot.coulomb):
        raise robot.error("coulomb", 'is zero, and the model error "friction" forgets it; give numbers above zero')
    if "flexible" in errors and not np.all(study.robot.rotor_inertia):
        raise robot.error("rotor_inertia", 'must be above zero in all joints for the model error "flexible"')
