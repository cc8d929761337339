"""Robots by name: the paper's KR500 and those of the installed distribution example-robot-data."""

from __future__ import annotations

import difflib
import os
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from os import PathLike
from pathlib import Path, PurePosixPath

from graphdyn.experiments import GRAVITY as KR500_GRAVITY
from graphdyn.model import STANDARD_GRAVITY
from urdf.document.described_robots import PACKAGE, SUFFIX, described_robot
from urdf.errors import RobotNotFound, shortened

DISTRIBUTION = "example-robot-data"
ROBOT_SUFFIX = "_robot"
"""Ending of file names that is not part of a robot's name: ur5_robot.urdf is "ur5", as in example_robot_data."""


@dataclass(frozen=True)
class RobotEntry:
    """A robot that urdf.load knows by name.

    name: what to call it; path: its URDF file on this machine
    origin: where the file comes from; licence: an SPDX expression, or where to read it
    gravity: of the loaded model, world axes               (3,)  [m/s²]
    """

    name: str
    path: Path
    origin: str
    licence: str
    gravity: tuple[float, float, float]


@cache
def robots() -> tuple[RobotEntry, ...]:
    """The catalog, the paper's KR500 first. No file is opened."""
    return (
        RobotEntry(
            "kr500",
            Path(__file__).parents[1] / "robots" / "kr500.urdf",
            "graphdyn: geometry of the paper's KR500",
            "BSD-3-Clause",
            KR500_GRAVITY,
        ),
        *_example_robots(),
    )


def locate(path_or_name: str | PathLike[str]) -> tuple[Path, tuple[float, float, float]]:
    """File and default gravity [m/s²] of a path or name.

    A string that names a robot of the catalog is that robot, else a file, else a robot of the catalog in other
    capitals, else one that the cache of robot_descriptions has.

    Raises RobotNotFound with close names.
    """
    entries = {entry.name: entry for entry in robots()} if isinstance(path_or_name, str) else {}
    if path_or_name in entries:
        entry = entries[str(path_or_name)]
        return entry.path, entry.gravity
    path = Path(path_or_name)
    if os.path.isfile(path):  # unlike Path.is_file, it does not raise for impossible names
        return path, STANDARD_GRAVITY
    if os.path.isdir(path):
        raise RobotNotFound(f"'{shortened(str(path))}' is a folder", "give a URDF file in it")
    if not entries:
        raise RobotNotFound(f"'{shortened(str(path))}' is not a file", "give a file, or a robot's name as a string")
    by_small_letters = {name.lower(): name for name in entries}
    if same := by_small_letters.get(str(path_or_name).lower()):
        return entries[same].path, entries[same].gravity
    described = described_robot(str(path_or_name))
    if described is not None and described.path is not None:
        return described.path, STANDARD_GRAVITY
    close = [by_small_letters[name] for name in difflib.get_close_matches(str(path_or_name).lower(), by_small_letters)]
    remedy = (
        f"close names: {', '.join(close)}; `graphdyn robots` lists all"
        if close
        else "`graphdyn robots` lists all names"
    )
    if described is not None:
        remedy += f". The package {PACKAGE} has it; run: python -m {PACKAGE} pull {described.name}"
    elif str(path_or_name).lower().endswith(SUFFIX):
        remedy += f". It may be one of the package {PACKAGE}; run: python -m pip install {PACKAGE} && "
        remedy += f"python -m {PACKAGE} pull {str(path_or_name).lower()}"
    if not _files():
        remedy += f". Most robots come with the package {DISTRIBUTION}, which is not installed; run: "
        remedy += f"python -m pip install {DISTRIBUTION}"
    raise RobotNotFound(f"'{shortened(str(path_or_name))}' is neither a file nor a robot of the catalog", remedy)


def _files() -> list[metadata.PackagePath]:
    """The files that the distribution installed; version 6 has no Python module through which to find them."""
    try:
        return metadata.files(DISTRIBUTION) or []
    except metadata.PackageNotFoundError:
        return []


def _example_robots() -> list[RobotEntry]:
    files = [file for file in _files() if _folder(file) is not None]
    if not files:
        return []
    about = metadata.metadata(DISTRIBUTION)
    licence = (about.get_all("License-Expression") or ["not stated"])[0]
    licences = {_folder(file): f"see {_short(file)} of {DISTRIBUTION}" for file in files if file.name == "LICENSE"}
    return [
        RobotEntry(
            name,
            Path(str(file.locate())),
            f"{DISTRIBUTION} {about['Version']}: {_short(file)}",
            licences.get(_folder(file), licence),
            STANDARD_GRAVITY,
        )
        for name, file in sorted(_names([file for file in files if file.suffix == ".urdf"]).items())
    ]


def _names(files: list[metadata.PackagePath]) -> dict[str, metadata.PackagePath]:
    """A file's name is its stem without "_robot"; of several files with one name, the "_robot" file gets it.

    The others are called folder/stem: "ur_description/ur3", "anymal_c_simple_description/anymal".
    """
    claims = defaultdict(list)
    for file in files:
        claims[file.stem.removesuffix(ROBOT_SUFFIX)].append(file)
    names = {}
    for name, claimants in claims.items():
        preferred = [file for file in claimants if len(claimants) == 1 or file.stem.endswith(ROBOT_SUFFIX)]
        for file in claimants:
            names[name if preferred == [file] else f"{_folder(file)}/{file.stem}"] = file
    return names


def _short(file: metadata.PackagePath) -> PurePosixPath:
    """The path from the folder "robots" on."""
    return PurePosixPath(*file.parts[file.parts.index("robots") :])


def _folder(file: metadata.PackagePath) -> str | None:
    """The folder of one robot family below "robots"; None for files elsewhere."""
    return _short(file).parts[1] if "robots" in file.parts[:-2] else None
