"""Robots of the package robot_descriptions, as far as its cache has them: nothing is downloaded."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module, util
from os import environ
from os.path import expanduser, isdir, isfile
from pathlib import Path
from typing import Any

PACKAGE = "robot_descriptions"

SUFFIX = "_description"

CACHE_VARIABLE, USUAL_CACHE = "ROBOT_DESCRIPTIONS_CACHE", "~/.cache/robot_descriptions"
"""Environment variable that names the folder of the cache, and its value where there is none."""


class _NotCached(Exception):
    pass


@dataclass(frozen=True)
class DescribedRobot:
    """A description by its name there. path: of its URDF; None where the cache does not have it"""

    name: str
    path: Path | None


def described_robot(name: str) -> DescribedRobot | None:
    """The description of this name, whatever its capitals, with or without "_description" at its end.

    None where the package, or such a description, is missing.
    """
    name = name.lower().removesuffix(SUFFIX) + SUFFIX
    if not name.isidentifier() or util.find_spec(PACKAGE) is None or util.find_spec(f"{PACKAGE}.{name}") is None:
        return None
    try:
        return DescribedRobot(name, _cached(f"{PACKAGE}.{name}"))
    except ImportError:  # of git, which the package needs
        return DescribedRobot(name, None)


def _cached(module: str) -> Path | None:
    """The URDF that a description names, imported with a cache that only looks."""
    cache: Any = import_module(f"{PACKAGE}._cache")
    repositories = import_module(f"{PACKAGE}._repositories").REPOSITORIES
    clone = cache.clone_to_cache

    def look(repository: str, commit: str | None = None) -> str:
        below = Path(expanduser(environ.get(CACHE_VARIABLE, USUAL_CACHE)), repositories[repository].cache_path)
        if commit is not None or not isdir(below):
            raise _NotCached
        return str(below)

    cache.clone_to_cache = look
    try:
        path = getattr(import_module(module), "URDF_PATH", None)
    except _NotCached:
        return None
    finally:
        cache.clone_to_cache = clone
    return Path(path) if path is not None and isfile(path) else None
