"""The configuration of a study: a TOML file, or one of those that come with the package, by name.

Methods are named as in METHODS, or FILE.py:NAME for one of one's own, whose code runs only if that is allowed.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.identifying import ESTIMATORS
from crosscheck.study.settings.design import StudyDesign, study_design
from crosscheck.study.settings.recordings import StudyRecording, recordings
from crosscheck.study.settings.scenarios import Scenario, scenarios
from crosscheck.study.settings.settings import (
    BadConfiguration,
    ErrorSettings,
    RobotSettings,
    Settings,
    all_robots,
    error_settings,
    texts,
    whole,
    words,
)
from crosscheck.user_code import imported_files, refuse_code
from graphdyn import InvalidInput
from graphdyn.identification import Estimator
from urdf.document import toml_document


def methods_reader(folder: Path, everything: tuple[str, ...]) -> Callable[[object], tuple[str, ...]]:
    """A reader of lists of methods. folder: in which files of one's own are; everything: what "all" stands for"""

    def read(value: object) -> tuple[str, ...]:
        names = everything if value == "all" else texts('methods, or "all"')(value)
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
    if name in ESTIMATORS:
        return name
    raise ValueError(f"there is no method '{name}'; use {', '.join(ESTIMATORS)}, all, or FILE.py:NAME")


def measurable_methods(points: Sequence[Scenario]) -> tuple[str, ...]:
    """All methods; those that take wrenches for measured only where a scenario measures them."""
    wrenches = any(scenario.force_noise is not None for scenario in points)
    return tuple(name for name, made in ESTIMATORS.items() if wrenches or not takes_wrenches(made()))


def torque_methods(study: Configuration) -> list[str]:
    """Its methods without those that take wrenches for measured, which are compared among themselves."""
    return [name for name in study.methods if name not in ESTIMATORS or not takes_wrenches(ESTIMATORS[name]())]


def takes_wrenches(estimator: Estimator) -> bool:
    """It asks for a recording, which has joint wrenches, beside the problem."""
    return hasattr(estimator, "recording")


def shown_name(method: str) -> str:
    """The name in tables: that of METHODS; of an own one FILE:NAME without its folder."""
    where, colon, name = method.rpartition(":")
    return f"{Path(where).stem}:{name}" if colon else method


SHIPPED_CONFIGURATIONS = ("small", "birdy", "benchmark")
"""Configurations that come with the package."""

MAX_RUNS = 1_000_000
"""Largest number of runs of every scenario."""

DEFAULT_RUNS = 12
"""Runs of every scenario: with fewer than ten, twenty methods cannot be told from the reference."""

SIMULATION_TABLES = ("robot", "errors", "scenario", "grid")

CONFIGURATION_TABLES = ("study", *SIMULATION_TABLES, "recordings")


@dataclass(frozen=True)
class Configuration:
    """What to simulate, and what to identify with.

    file: name for messages; text: of the file
    seed: of all random numbers; runs: of every scenario
    design: what each run draws anew, and which methods are compared
    methods: names (METHODS), or FILE.py:NAME with the whole path of the file
    robots: each with a label of its own; without robots there are no scenarios, and real recordings alone
    folder: in which paths of the configuration begin
    recordings: real ones
    """

    file: str
    text: str
    seed: int
    runs: int
    design: StudyDesign
    methods: tuple[str, ...]
    robots: tuple[RobotSettings, ...]
    errors: ErrorSettings
    scenarios: tuple[Scenario, ...]
    folder: Path
    recordings: tuple[StudyRecording, ...]

    @property
    def origin(self) -> str:
        """Its whole path, or the name of a configuration of the package."""
        path = self.folder / Path(self.file).name
        return str(path) if path.is_file() else self.file

    @property
    def recorded_files(self) -> dict[str, str]:
        """Hash of every file of the recordings."""
        return {file: hash_of(Path(file)) for recording in self.recordings for file in recording.files}

    def robot_of(self, scenario: Scenario) -> RobotSettings:
        return next(robot for robot in self.robots if robot.label == scenario.robot)

    @property
    def own_methods(self) -> tuple[str, ...]:
        """FILE.py:NAME with the whole path."""
        return tuple(method for method in self.methods if ":" in method)

    @property
    def own_laws(self) -> tuple[str, ...]:
        """FILE.py:NAME of motions, noise and errors of the model with the whole path."""
        words = [word for one in self.scenarios for word in (one.motion, one.torque_noise_law, one.model_error)]
        return tuple(dict.fromkeys(self.located(word) for word in words if ":" in word))

    def located(self, word: str) -> str:
        """FILE.py:NAME with the whole path; another word as it is."""
        where, colon, name = word.rpartition(":")
        return f"{(self.folder / where).resolve()}:{name}" if colon else word

    @property
    def own_files(self) -> dict[str, str]:
        """Hash of every file that the study reads beside its configuration: own methods, motions, laws of noise and
        errors of the model, the modules of their folder that they import, and the robots'.
        """
        own = dict.fromkeys(code.rpartition(":")[0] for code in (*self.own_methods, *self.own_laws))
        paths = list(dict.fromkeys(str(file) for path in own for file in imported_files(Path(path))))
        paths += [robot.name for robot in self.robots if Path(robot.name).is_file()]
        return {path: hash_of(Path(path)) for path in paths}


def hash_of(file: Path) -> str:
    return hashlib.sha256(file.read_bytes()).hexdigest()


def read_configuration(name: str, *, allow_code: bool = False) -> Configuration:
    """One of SHIPPED_CONFIGURATIONS, or a file.

    allow_code: let methods, motions and laws of noise FILE.py:NAME run, whose code can do whatever the user can

    Raises BadConfiguration, OSError.
    """
    path = Path(name)
    if name in SHIPPED_CONFIGURATIONS:
        shipped = resources.files("crosscheck.study") / "configurations"
        with resources.as_file(shipped) as folder:  # where its robots are
            return configuration_of((folder / f"{name}.toml").read_bytes(), name, folder, allow_code=allow_code)
    if not path.is_file():
        raise BadConfiguration(
            f"there is no file {name}; name a configuration, or one of {', '.join(SHIPPED_CONFIGURATIONS)}"
        )
    return configuration_of(path.read_bytes(), name, path.resolve().parent, allow_code=allow_code)


def configuration_of(content: bytes, file: str, folder: Path, *, allow_code: bool = False) -> Configuration:
    """file: for messages; folder: in which paths of the configuration begin; allow_code: as in read_configuration

    What it answers has no code but what is allowed. Raises BadConfiguration.
    """
    try:
        document = toml_document(content)
    except ValueError as error:
        raise BadConfiguration(f"{file}: {error}") from None
    for table in document:
        if table not in CONFIGURATION_TABLES:
            raise BadConfiguration(
                f"{file}: [{table}] is no table of a study; it has: {', '.join(CONFIGURATION_TABLES)}"
            )
    grids = document.get("grid", [{}])
    if not isinstance(grids, list):
        raise BadConfiguration(f"{file}: [grid] must be [[grid]], which can be given several times")
    recorded = document.get("recordings", [])
    if not isinstance(recorded, list):
        raise BadConfiguration(f"{file}: [recordings] must be [[recordings]], which can be given several times")
    alone = bool(recorded) and not set(document) & set(SIMULATION_TABLES)
    given = document.get("robot", [] if alone else {})
    robots = given if isinstance(given, list) and (given or alone) else [given]
    tables = {name: document.get(name, {}) for name in ("study", "errors", "scenario")}
    lists = {"robot": robots, "grid": grids, "recordings": recorded}
    several = [*tables.items(), *((name, one) for name, found in lists.items() for one in found)]
    for name, table in several:
        if not isinstance(table, dict):
            raise BadConfiguration(f"{file}: {name} is {table!r}; it must be a table, [{name}]")
    study, errors, common = (Settings(file, name, table) for name, table in tables.items())
    machines, numbered = _numbered(file, "robot", robots), _numbered(file, "grid", grids)
    arms = all_robots(machines, folder)
    points = scenarios(common, numbered, [robot.label for robot in arms]) if arms else ()
    everything = measurable_methods(points)
    found = Configuration(
        file,
        content.decode(),
        study.take("seed", 0, whole(0)),
        study.take("runs", DEFAULT_RUNS, whole(1, MAX_RUNS)),
        study_design(study, lambda name: shown_name(_method(folder, words(name)))),
        study.take("methods", everything, methods_reader(folder, everything)),
        arms,
        error_settings(errors),
        points,
        folder,
        recordings(_numbered(file, "recordings", recorded), folder),
    )
    study.refuse_others()
    _check(found, study, machines)
    for law in found.own_laws:
        if not Path(law.rpartition(":")[0]).is_file():
            raise BadConfiguration(f"{file}: there is no file {law.rpartition(':')[0]} for a motion, noise or an error")
    try:
        of_recordings = [code for recording in found.recordings for code in recording.code]
        for where, codes in (
            ("methods in [study]", found.own_methods),
            ("scenarios", found.own_laws),
            ("recordings", of_recordings),
        ):
            if codes:
                refuse_code(f"{file}: {where}", codes, allow_code)
    except InvalidInput as refused:
        raise BadConfiguration(str(refused)) from None
    return found


def _numbered(file: str, name: str, tables: Sequence[Mapping[str, Any]]) -> list[Settings]:
    """Tables of one name, with their number where there are several."""
    return [Settings(file, f"{name} {k}" if len(tables) > 1 else name, table) for k, table in enumerate(tables, 1)]


def _check(study: Configuration, table: Settings, machines: Sequence[Settings]) -> None:
    """Raises BadConfiguration for a scenario that this robot cannot have, or no method can use, and the reverse."""
    names = [shown_name(method) for method in study.methods]
    if study.design.reference not in (None, *names):
        raise table.error(
            "reference", f"is {study.design.reference}, which is not among the methods: {', '.join(names)}"
        )
    measured = {scenario.force_noise is not None for scenario in study.scenarios}
    need = [name for name in study.methods if name in ESTIMATORS and takes_wrenches(ESTIMATORS[name]())]
    if need and (measured == {False} or (False in measured and len(need) == len(study.methods))):
        where = "no scenario" if measured == {False} else "not every scenario"
        what = f"has {', '.join(need)} for wrenches, which {where} measures; give a force_noise, or other methods"
        raise table.error("methods", what)
    for robot, own in zip(study.robots, machines, strict=True):
        errors = {scenario.model_error for scenario in study.scenarios if scenario.robot == robot.label}
        if "friction" in errors and not np.any(robot.coulomb):
            raise own.error("coulomb", 'is zero, and the model error "friction" forgets it; give numbers above zero')
        for error in sorted({"stribeck", "lugre"} & errors):
            if not np.all(robot.coulomb):
                raise own.error("coulomb", f'must be above zero in all joints for the model error "{error}"')
        if "flexible" in errors and not np.all(robot.rotor_inertia):
            raise own.error("rotor_inertia", 'must be above zero in all joints for the model error "flexible"')
